#include "exchanges.hpp"

namespace tact {
namespace {

std::uint64_t fingerprint(const std::vector<char>& active) {
    std::uint64_t hash = 1469598103934665603ULL;
    for (const char on : active) hash = (hash ^ static_cast<std::uint64_t>(on)) * 1099511628211ULL;
    return hash;
}

}  // namespace

void Exchanges::start() {
    visited_.clear();
    careful_ = false;
}

bool Exchanges::apply(std::vector<char>& active, const std::vector<Index>& wrong) {
    if (visited_.empty()) visited_.insert(fingerprint(active));
    bool all = true;
    if (careful_) {
        if (wrong.size() < fewest_) {
            fewest_ = wrong.size();
            patience_ = patient;
        } else if (patience_ > 0) {
            --patience_;
        }
        all = patience_ > 0;
    }
    for (std::size_t k = 0; k < (all ? wrong.size() : 1); ++k) active[static_cast<std::size_t>(wrong[k])] ^= 1;
    if (visited_.insert(fingerprint(active)).second) return true;
    visited_.clear();
    if (!careful_) {
        careful_ = true;
        fewest_ = wrong.size();
        patience_ = patient;
    }
    return false;
}

}  // namespace tact
