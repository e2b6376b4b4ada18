#include "chebyshev_series.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "../../lib/errors.hpp"

namespace tact {
namespace {

Index product(const std::vector<Index>& counts) {
    return std::accumulate(counts.begin(), counts.end(), Index{1}, std::multiplies<>());
}

void check_box(const Parameter& lower, const Parameter& upper) {
    if (lower.size() != upper.size() || !lower.allFinite() || !upper.allFinite() || (upper - lower).minCoeff() < 0)
        throw InputError("fit_chebyshev: the box is not finite with lower <= upper in " +
                         std::to_string(lower.size()) + " parameters, expected that");
}

double node(Index i, Index count) {
    return std::cos(std::numbers::pi * (2 * static_cast<double>(i) + 1) / (2 * static_cast<double>(count)));
}

/// Values at the nodes -> coefficients, in one parameter: (2/n) cos(k (2i+1) pi / 2n), half of it for k = 0.
DenseMatrix transform(Index count) {
    DenseMatrix T(count, count);
    for (Index k = 0; k < count; ++k)
        for (Index i = 0; i < count; ++i)
            T(k, i) =
                (k == 0 ? 1.0 : 2.0) / static_cast<double>(count) *
                std::cos(std::numbers::pi * static_cast<double>(k * (2 * i + 1)) / (2 * static_cast<double>(count)));
    return T;
}

/// The k of a column of the series in one parameter.
Index degree(Index column, const std::vector<Index>& counts, std::size_t parameter) {
    for (std::size_t j = 0; j < parameter; ++j) column /= counts[j];
    return column % counts[parameter];
}

class Fit {
public:
    Fit(const ParameterFunction& function, Index size, const Parameter& lower, const Parameter& upper,
        const ChebyshevOptions& options)
        : function_(function), size_(size), options_(options) {
        series_.lower = lower;
        series_.upper = upper;
        for (Index j = 0; j < lower.size(); ++j) series_.counts.push_back(upper[j] > lower[j] ? 4 : 1);
    }

    ChebyshevFit run() {
        ChebyshevFit fit;
        if (product(series_.counts) > options_.max_points) return fit;
        for (;;) {
            interpolate();
            std::vector<Index> grown = series_.counts;
            fit.resolved = true;
            for (std::size_t j = 0; j < grown.size(); ++j) {
                if (grown[j] == 1 || largest_from(j, grown[j] - 2) <= options_.tolerance * scale_) continue;
                fit.resolved = false;
                grown[j] = std::min(options_.max_count, grown[j] + grown[j] / 2);
            }
            if (fit.resolved || grown == series_.counts || product(grown) > options_.max_points) break;
            series_.counts = std::move(grown);
        }
        trim();
        fit.series = series_;
        fit.error = measure();
        return fit;
    }

private:
    void interpolate() {
        const std::vector<Index>& counts = series_.counts;
        DenseMatrix& values = series_.coefficients;
        values.resize(size_, product(counts));
        Parameter gamma = series_.lower;
        for (Index column = 0; column < values.cols(); ++column) {
            for (std::size_t j = 0; j < counts.size(); ++j) {
                const auto k = static_cast<Index>(j);
                const double x = node(degree(column, counts, j), counts[j]);
                gamma[k] = 0.5 * ((1 - x) * series_.lower[k] + (1 + x) * series_.upper[k]);
            }
            function_(gamma, values.col(column));
        }
        scale_ = values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0;
        Index stride = 1;
        for (const Index count : counts) {
            const DenseMatrix T = transform(count);
            for (Index first = 0; first < values.cols(); ++first) {
                if ((first / stride) % count != 0) continue;
                DenseMatrix line(size_, count);
                for (Index i = 0; i < count; ++i) line.col(i) = values.col(first + i * stride);
                line = (line * T.transpose()).eval();
                for (Index i = 0; i < count; ++i) values.col(first + i * stride) = line.col(i);
            }
            stride *= count;
        }
    }

    /// The largest coefficient whose polynomial in one parameter has at least this degree.
    double largest_from(std::size_t parameter, Index first) const {
        double largest = 0;
        for (Index column = 0; column < series_.coefficients.cols(); ++column)
            if (degree(column, series_.counts, parameter) >= first)
                largest = std::max(largest, series_.coefficients.col(column).cwiseAbs().maxCoeff());
        return largest;
    }

    /// Leaves out the highest degrees that have decayed below a tenth of the tolerance.
    void trim() {
        std::vector<Index> kept = series_.counts;
        for (std::size_t j = 0; j < kept.size(); ++j)
            while (kept[j] > 1 && largest_from(j, kept[j] - 1) <= 0.1 * options_.tolerance * scale_) --kept[j];
        std::vector<Index> columns;
        for (Index column = 0; column < series_.coefficients.cols(); ++column) {
            bool within = true;
            for (std::size_t j = 0; j < kept.size(); ++j) within &= degree(column, series_.counts, j) < kept[j];
            if (within) columns.push_back(column);
        }
        series_.coefficients = series_.coefficients(Eigen::all, columns).eval();
        series_.counts = std::move(kept);
    }

    double measure() const {
        double error = 0;
        Vector expected(size_);
        for (const Parameter& gamma : spread_points(series_.lower, series_.upper, 64)) {
            function_(gamma, expected);
            error = std::max(error, (series_.at(gamma) - expected).lpNorm<Eigen::Infinity>());
        }
        return scale_ > 0 ? error / scale_ : error;
    }

    const ParameterFunction& function_;
    Index size_;
    const ChebyshevOptions& options_;
    ChebyshevSeries series_;
    double scale_ = 0;
};

}  // namespace

Vector ChebyshevSeries::at(const Parameter& gamma) const {
    if (gamma.size() != lower.size())
        throw InputError("ChebyshevSeries: gamma is " + std::to_string(gamma.size()) + "x1, expected " +
                         std::to_string(lower.size()) + "x1");
    Vector polynomials(coefficients.cols());
    polynomials[0] = 1;
    Index filled = 1;
    for (std::size_t j = 0; j < counts.size(); ++j) {
        const auto k = static_cast<Index>(j);
        const double width = upper[k] - lower[k];
        const double x = width > 0 ? (2 * gamma[k] - lower[k] - upper[k]) / width : 0;
        // Blocks of what is there times T_0, T_1, ...: each from the two before it.
        for (Index i = 1; i < counts[j]; ++i) {
            auto block = polynomials.segment(i * filled, filled);
            if (i == 1)
                block = x * polynomials.head(filled);
            else
                block = 2 * x * polynomials.segment((i - 1) * filled, filled) -
                        polynomials.segment((i - 2) * filled, filled);
        }
        filled *= counts[j];
    }
    return coefficients * polynomials;
}

ChebyshevFit fit_chebyshev(const ParameterFunction& function, Index size, const Parameter& lower,
                           const Parameter& upper, const ChebyshevOptions& options) {
    check_box(lower, upper);
    return Fit(function, size, lower, upper, options).run();
}

std::vector<Parameter> spread_points(const Parameter& lower, const Parameter& upper, Index count) {
    const Index d = lower.size();
    if (d == 0) return {Parameter()};
    double root = 2;
    for (int k = 0; k < 64; ++k) root = std::pow(1 + root, 1.0 / static_cast<double>(d + 1));
    std::vector<Parameter> points;
    for (Index i = 0; i < count; ++i) {
        Parameter gamma(d);
        for (Index j = 0; j < d; ++j) {
            const double place = 0.5 + static_cast<double>(i) * std::pow(root, -static_cast<double>(j + 1));
            gamma[j] = lower[j] + (place - std::floor(place)) * (upper[j] - lower[j]);
        }
        points.push_back(std::move(gamma));
    }
    return points;
}

}  // namespace tact
