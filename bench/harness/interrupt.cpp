#include "interrupt.hpp"

#include <csignal>  // sigaction too

namespace tact::bench {
namespace {

volatile std::sig_atomic_t signalled = 0;

void note(int signal) {
    signalled = 1;
    std::signal(signal, SIG_DFL);  // the next one ends the process
}

}  // namespace

void catch_interrupts() {
    // Without SA_RESTART, which std::signal sets: who waits for another process has to wake up.
    struct sigaction action = {};
    action.sa_handler = note;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return signalled != 0; }

void throw_if_interrupted() {
    if (interrupted()) throw Interrupted();
}

Observer stop_on_interrupt() {
    return [](const State&, const StepReport&) { return interrupted() ? Flow::stop : Flow::proceed; };
}

}  // namespace tact::bench
