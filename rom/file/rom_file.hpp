// Reduced models on disk.
#pragma once

#include <filesystem>

#include "../../lib/io/sealed_file.hpp"
#include "../model/reduced_model.hpp"

namespace tact {

/// What a file of this format begins with; the number changes with any change of its arrays.
inline constexpr FileKind reduced_model_file{"tact reduced model", 1};

/// One HDF5 file behind a block of text (sealed_file.hpp) with everything in ReducedModelData; numbers keep their bits, so
/// a model that is loaded answers as the one that was saved. Written whole or not at all. InputError if it cannot be.
void save_reduced_model(const std::filesystem::path& path, const ReducedModelData& model);

/// InputError that names the path if the file cannot be read, is of another kind or format version, is damaged, or holds
/// data that do not fit together. Nothing of the full model is needed.
ReducedModelData load_reduced_model(const std::filesystem::path& path);

}  // namespace tact
