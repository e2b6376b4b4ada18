#include "checkpoint.hpp"

#include <array>
#include <cstdio>
#include <fstream>

#include "../../lib/io/write_file.hpp"
#include "archive.hpp"

namespace tact {
namespace {

constexpr std::string_view magic = "tact training, version 1, this machine's byte order\n";

std::string printed(double x) {
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%.17g", x);
    return text.data();
}

/// Numbers as their checksum.
class Digest {
public:
    void add(const DenseMatrix& X) {
        checksum_.add(reinterpret_cast<const char*>(X.data()), sizeof(double) * static_cast<std::size_t>(X.size()));
    }
    /// By its products with two vectors, of whatever kind it is.
    void add(const Matrix& A) {
        DenseMatrix probes(A.cols(), 2);
        for (Index i = 0; i < A.cols(); ++i) {
            probes(i, 0) = 1 + static_cast<double>(i % 7);
            probes(i, 1) = 1 / (1 + static_cast<double>(i));
        }
        add(A.times(probes));
    }
    void add(const std::optional<Matrix>& A) {
        if (A) add(*A);
    }
    template <class Number> void add(const std::vector<Number>& numbers) {
        for (const Number x : numbers) {
            const double value = static_cast<double>(x);
            checksum_.add(reinterpret_cast<const char*>(&value), sizeof value);
        }
    }
    std::string text() const {
        std::array<char, 20> text{};
        std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(checksum_.value()));
        return text.data();
    }

private:
    Checksum checksum_;
};

std::string digest_of(const ContactProblem& problem) {
    Digest digest;
    digest.add(problem.M);
    digest.add(problem.D);
    digest.add(problem.K);
    digest.add(problem.B);
    digest.add(problem.c.dense_modes("train: c"));
    digest.add(problem.f.dense_modes("train: f"));
    digest.add(problem.u0);
    digest.add(problem.v0);
    return digest.text();
}

std::string digest_of(const std::vector<Parameter>& parameters) {
    Digest digest;
    for (const Parameter& gamma : parameters) digest.add(DenseMatrix(gamma));
    return std::to_string(parameters.size()) + " with checksum " + digest.text();
}

}  // namespace

TrainingIdentity training_identity(const ContactFamily& family, const TrainingMethod& method,
                                   const TrainingOptions& options, const PodAccumulatorOptions& pod) {
    Parameter first;
    if (options.first)
        first = *options.first;
    else if (!options.candidates.empty())
        first = options.candidates.front();
    const ContactProblem problem = family.at(first);
    TrainingIdentity identity;
    const auto add = [&](const char* name, std::string value) { identity.emplace_back(name, std::move(value)); };
    add("unknowns", std::to_string(problem.size()));
    add("constraints", std::to_string(problem.constraints()));
    add("problem", "one with checksum " + digest_of(problem));
    add("integrator", method.integrator ? method.integrator->name() : "none");
    add("grid", method.integrator ? std::to_string(method.grid.steps) + " steps of " + printed(method.grid.dt) +
                                        " from " + printed(method.grid.t0)
                                  : "none");
    add("candidates", digest_of(options.candidates));
    add("first", options.first ? digest_of(std::vector{*options.first}) : "the nearest to the centre");
    add("selection", options.selection == Selection::greedy ? "greedy" : "in order");
    add("compression", !options.compression                        ? "as usual"
                       : *options.compression == Compression::none ? "none"
                                                                   : "pod_and_dual_basis");
    add("snapshots", std::to_string(options.snapshots.primal) + ", " + std::to_string(options.snapshots.dual) + ", " +
                         printed(options.snapshots.tolerance));
    add("weights", printed(options.weights.penetration) + ", " + printed(options.weights.complementarity) + ", " +
                       printed(options.weights.negativity));
    Digest steps;
    steps.add(options.indicator_steps);
    add("indicator steps", std::to_string(options.indicator_stride) + ", " + steps.text());
    add("oracle", options.oracle ? "given" : "none");
    Digest inner_product;
    inner_product.add(pod.inner_product);
    add("pod", printed(pod.tolerance) + ", " + std::to_string(pod.max_vectors) + ", " + inner_product.text() + ", " +
                   printed(options.pod_tolerance));
    Digest primal;
    primal.add(options.primal.body_of);
    primal.add(options.primal.held);
    add("primal", std::to_string(options.primal.held.cols()) + ", " + primal.text());
    add("supremizers", printed(options.supremizers.share) + ", " + printed(options.supremizers.a));
    return identity;
}

void write_checkpoint(const std::filesystem::path& file, const TrainingIdentity& identity, TrainingState& state) {
    write_file(file, [&](std::ostream& out) {
        out << magic;
        ArchiveWriter archive(out);
        std::int64_t entries = static_cast<std::int64_t>(identity.size());
        archive(entries);
        for (auto [name, value] : identity) archive(name, value);
        archive(state);
        std::uint64_t checksum = archive.checksum();
        archive(checksum);
    });
}

bool read_checkpoint(const std::filesystem::path& file, const TrainingIdentity& identity, TrainingState& state) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return false;
    const std::string what = "train: checkpoint " + file.string();
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    std::ifstream in(file, std::ios::binary);
    if (error || !in) throw InputError(what + " cannot be read");
    std::string line(magic.size(), ' ');
    if (!in.read(line.data(), static_cast<std::streamsize>(line.size())) || line != magic)
        throw InputError(what + " does not begin with \"" + std::string(magic.substr(0, magic.size() - 1)) + "\"");
    ArchiveReader archive(in, size - magic.size(), what);
    std::int64_t entries = 0;
    archive(entries);
    if (entries != static_cast<std::int64_t>(identity.size()))
        throw InputError(what + " names " + std::to_string(entries) + " properties, expected " +
                         std::to_string(identity.size()));
    for (const auto& [name, value] : identity) {
        std::string its_name, its_value;
        archive(its_name, its_value);
        if (its_name != name || its_value != value)
            throw InputError(what + " is of another training: " + its_name + " is " + its_value + ", expected " +
                             (its_name == name ? "" : name + " ") + value);
    }
    archive(state);
    const std::uint64_t computed = archive.checksum();
    std::uint64_t stored = 0;
    archive(stored);
    if (stored != computed) throw InputError(what + " is damaged: its checksum is not that of its content");
    return true;
}

}  // namespace tact
