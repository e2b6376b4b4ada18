#include "sampling.hpp"

#include <gsl/gsl_qrng.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include <memory>
#include <numeric>
#include <string>

#include "../../lib/errors.hpp"

namespace tact {
namespace {

void check_box(const char* where, const Parameter& lower, const Parameter& upper) {
    if (lower.size() != upper.size() || lower.size() == 0)
        throw InputError(std::string(where) + ": lower has " + std::to_string(lower.size()) + " entries and upper " +
                         std::to_string(upper.size()) + ", expected as many, at least one");
    for (Index k = 0; k < lower.size(); ++k)
        if (!(lower[k] <= upper[k]) || lower[k] == -infinity || upper[k] == infinity)
            throw InputError(std::string(where) + ": parameter " + std::to_string(k) + " ranges from " +
                             shown(lower[k]) + " to " + shown(upper[k]) +
                             ", expected finite bounds in ascending order");
}

std::vector<Parameter> quasi_random(const char* where, const gsl_qrng_type* type, const Parameter& lower,
                                    const Parameter& upper, Index count) {
    check_box(where, lower, upper);
    if (count < 1)
        throw InputError(std::string(where) + ": count is " + std::to_string(count) + ", expected at least 1");
    if (lower.size() > static_cast<Index>(type->max_dimension))
        throw InputError(std::string(where) + ": lower has " + std::to_string(lower.size()) +
                         " entries, expected at most " + std::to_string(type->max_dimension));
    const std::unique_ptr<gsl_qrng, decltype(&gsl_qrng_free)> sequence(
        gsl_qrng_alloc(type, static_cast<unsigned int>(lower.size())), &gsl_qrng_free);
    std::vector<Parameter> points(static_cast<std::size_t>(count), lower);
    Vector x(lower.size());
    for (Parameter& point : points) {
        gsl_qrng_get(sequence.get(), x.data());
        point = (1 - x.array()) * lower.array() + x.array() * upper.array();
    }
    return points;
}

}  // namespace

std::vector<Parameter> tensor_grid(const Parameter& lower, const Parameter& upper, const std::vector<Index>& counts,
                                   GridKind kind) {
    check_box("tensor_grid", lower, upper);
    if (static_cast<Index>(counts.size()) != lower.size())
        throw InputError("tensor_grid: counts has " + std::to_string(counts.size()) + " entries, expected " +
                         std::to_string(lower.size()));
    const Index least = kind == GridKind::closed ? 2 : 1;
    Index total = 1;
    for (std::size_t k = 0; k < counts.size(); ++k) {
        if (counts[k] < least)
            throw InputError("tensor_grid: counts[" + std::to_string(k) + "] is " + std::to_string(counts[k]) +
                             ", expected at least " + std::to_string(least));
        total *= counts[k];
    }
    std::vector<Parameter> points(static_cast<std::size_t>(total), lower);
    for (Index i = 0; i < total; ++i)
        for (Index k = 0, rest = i; k < lower.size(); ++k) {
            const Index count = counts[static_cast<std::size_t>(k)], place = rest % count;
            rest /= count;
            const double x = kind == GridKind::closed
                                 ? static_cast<double>(place) / static_cast<double>(count - 1)
                                 : (static_cast<double>(place) + 0.5) / static_cast<double>(count);
            // Exactly `upper` at its end, which lower + 1 (upper - lower) need not be.
            points[static_cast<std::size_t>(i)][k] = (1 - x) * lower[k] + x * upper[k];
        }
    return points;
}

std::vector<Parameter> latin_hypercube(const Parameter& lower, const Parameter& upper, Index count,
                                       std::uint32_t seed) {
    check_box("latin_hypercube", lower, upper);
    if (count < 1) throw InputError("latin_hypercube: count is " + std::to_string(count) + ", expected at least 1");
    const std::unique_ptr<gsl_rng, decltype(&gsl_rng_free)> rng(gsl_rng_alloc(gsl_rng_mt19937), &gsl_rng_free);
    gsl_rng_set(rng.get(), seed);
    std::vector<Parameter> points(static_cast<std::size_t>(count), lower);
    std::vector<Index> slices(points.size());
    for (Index k = 0; k < lower.size(); ++k) {
        std::iota(slices.begin(), slices.end(), Index{0});
        gsl_ran_shuffle(rng.get(), slices.data(), slices.size(), sizeof(Index));
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double x =
                (static_cast<double>(slices[i]) + gsl_rng_uniform(rng.get())) / static_cast<double>(count);
            points[i][k] = (1 - x) * lower[k] + x * upper[k];
        }
    }
    return points;
}

std::vector<Parameter> sobol_sequence(const Parameter& lower, const Parameter& upper, Index count) {
    return quasi_random("sobol_sequence", gsl_qrng_sobol, lower, upper, count);
}

std::vector<Parameter> halton_sequence(const Parameter& lower, const Parameter& upper, Index count) {
    return quasi_random("halton_sequence", gsl_qrng_halton, lower, upper, count);
}

Index nearest_to_centre(const std::vector<Parameter>& points, const Parameter& lower, const Parameter& upper) {
    if (points.empty()) throw InputError("nearest_to_centre: there are no points, expected at least one");
    Index best = 0;
    double best_distance = infinity;
    for (std::size_t i = 0; i < points.size(); ++i) {
        double distance = 0;
        for (Index k = 0; k < lower.size(); ++k) {
            const double side = upper[k] - lower[k];
            const double x = side > 0 ? (points[i][k] - (lower[k] + upper[k]) / 2) / side : 0;
            distance += x * x;
        }
        // Rounding must not choose between the four points around the centre of an even grid.
        if (distance < best_distance * (1 - 1e-9)) {
            best_distance = distance;
            best = static_cast<Index>(i);
        }
    }
    return best;
}

}  // namespace tact
