#include "training_study.hpp"

#include <array>
#include <chrono>
#include <ctime>
#include <map>

#include "../../harness/basis_errors.hpp"
#include "../../harness/interrupt.hpp"
#include "../../harness/paper_study.hpp"
#include "../../harness/peak_memory.hpp"
#include "../../harness/timing.hpp"

namespace tact::bench {
namespace {

/// Peaks by part, taken where training says that the next one begins.
class PeakByPart {
public:
    PeakByPart() {
        (void)reset_peak_memory();
        before_ = peak_memory();
    }
    void at(std::string_view part) {
        if (part == part_) return;
        end_part();
        part_ = part;
    }
    Json megabytes() {
        end_part();
        Json json = Json::object();
        for (const auto& [part, field] : fields_)
            if (const auto found = peaks_.find(part); found != peaks_.end()) json[field] = found->second / 1e6;
        return json;
    }

private:
    void end_part() {
        const std::optional<double> peak = peak_memory();
        if (!part_.empty() && peak && before_) {
            double& most = peaks_[part_];
            most = std::max(most, *peak - *before_);
        }
        (void)reset_peak_memory();
    }
    static constexpr std::array<std::pair<const char*, const char*>, 4> fields_{
        {{"full run", "full_run"}, {"POD", "pod"}, {"dual basis", "dual_basis"}, {"candidates", "candidates"}}};
    std::optional<double> before_;
    std::string part_;
    std::map<std::string, double> peaks_;
};

struct Timed {
    TrainingResult result;
    double cpu = 0, elapsed = 0;
    Json peaks;
};

Timed timed_training(const PaperStudy& study, const Scheme& scheme, int threads) {
    TrainingOptions options = paper_training(study);
    options.threads = threads;
    PeakByPart peaks;
    options.observer = [&peaks](const TrainingProgress& at) {
        peaks.at(at.stage);
        return Flow::proceed;
    };
    Timed timed;
    const std::clock_t cpu = std::clock();
    const auto start = std::chrono::steady_clock::now();
    timed.result = train_with_progress(study, {scheme.integrator, scheme.grid}, options,
                                       threads == 1 ? "training" : "training, two threads");
    timed.cpu = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
    timed.elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    timed.peaks = peaks.megabytes();
    return timed;
}

void add_rows(const PaperStudy& study, const TrainingResult& trained, Json& rows) {
    double full = 0, pod = 0, dual = 0, projection = 0, candidates = 0;
    long solves = 0;
    for (const TrainingIteration& iteration : trained.history) {
        full += iteration.seconds_full;
        pod += iteration.seconds_pod;
        dual += iteration.seconds_dual;
        projection += iteration.seconds_projection;
        candidates += iteration.seconds_candidates;
        rows.push_back({{"scene", study.scene.name},
                        {"full_solves", ++solves},
                        {"p", iteration.p},
                        {"p_lambda", iteration.p_lambda},
                        {"snapshots", iteration.snapshots},
                        {"dual_snapshots", iteration.dual_snapshots},
                        {"full_run_seconds", full},
                        {"pod_seconds", pod},
                        {"dual_basis_seconds", dual},
                        {"projection_seconds", projection},
                        {"candidates_seconds", candidates}});
    }
}

/// CPU seconds of a run when all that does not depend on the query is there.
double warm_seconds(const ContactFamily& family, const Scheme& scheme, const Parameter& gamma,
                    std::shared_ptr<const ContactSolver> contact) {
    ContactWorkspace workspace(std::move(contact));
    const auto once = [&] { (void)run("query", family.at(gamma), scheme, workspace); };
    once();
    const int loops = std::max(1, static_cast<int>(0.02 / std::max(seconds_of(once), 1e-6)));
    return median_seconds(3,
                          [&] {
                              for (int k = 0; k < loops; ++k) once();
                          }) /
           loops;
}

Json scene_of(const PaperStudy& study, Json& rows) {
    const Scheme scheme = paper_scheme(study.scene);
    const Timed one = timed_training(study, scheme, 1), two = timed_training(study, scheme, 2);
    add_rows(study, one.result, rows);
    const ReducedBasis &a = one.result.basis, &b = two.result.basis;
    const double full = warm_seconds(*study.scene.family, scheme, study.tests.front(), study_contact().full);
    const double reduced = warm_seconds(*one.result.reduced, scheme, study.tests.front(), study_contact().reduced);
    Json json{{"scene", study.scene.name},
              {"full_solves", one.result.history.size()},
              {"candidates", paper_training(study).candidates.size()},
              {"training_seconds", one.cpu},
              {"training_elapsed_seconds", one.elapsed},
              {"two_threads_seconds", two.cpu},
              {"two_threads_elapsed_seconds", two.elapsed},
              {"two_threads_same_bits", a.U == b.U && a.U_lambda == b.U_lambda},
              {"peak_megabytes", one.peaks},
              {"full_seconds", full},
              {"reduced_seconds", reduced},
              {"break_even_queries", one.cpu / (full - reduced)}};
    return json;
}

}  // namespace

Json run_training(const StudyOptions& options) {
    Json json;
    json["study"] = "training";
    json["size"] = options.small ? "small" : "full";
    json["machine"] = machine();
    json["rows"] = json["scenes"] = Json::array();
    for (const std::string& name : wanted_scenes("training", options.scenes))
        json["scenes"].push_back(scene_of(paper_study(name, options.small), json["rows"]));
    return json;
}

}  // namespace tact::bench
