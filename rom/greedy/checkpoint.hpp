// Training that survives being killed: its state in a file, after every iteration.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "greedy.hpp"

namespace tact {

/// All that the next iteration depends on.
struct TrainingState {
    TrainingState(Index constraints, PodAccumulatorOptions options) : dual(constraints), pod(std::move(options)) {}

    std::vector<TrainingIteration> history;
    DualSnapshots dual;
    PodAccumulator pod;
    DenseMatrix raw;     ///< primal snapshots, where there is no compression
    ReducedBasis basis;  ///< of the last iteration

    template <class Archive> void serialize(Archive& archive) {
        archive(history, dual, pod, raw, basis.U, basis.U_lambda, basis.signs);
    }
};

/// Names and values of what a state belongs to.
using TrainingIdentity = std::vector<std::pair<std::string, std::string>>;

/// Of the problem (all its matrices, its load, and the gap at the first parameter) and of every option that decides the
/// result (`pod`: as it is in effect), but for functions, of which it only says whether they are there.
TrainingIdentity training_identity(const ContactFamily& family, const TrainingMethod& method,
                                   const TrainingOptions& options, const PodAccumulatorOptions& pod);

/// Replaces the file in one piece.
void write_checkpoint(const std::filesystem::path& file, const TrainingIdentity& identity, TrainingState& state);

/// False where there is no such file. InputError if it is of another training (naming what differs), of another version or
/// damaged; `state` is then not to be used.
bool read_checkpoint(const std::filesystem::path& file, const TrainingIdentity& identity, TrainingState& state);

}  // namespace tact
