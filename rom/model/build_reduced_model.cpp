#include "build_reduced_model.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "empirical_interpolation.hpp"
#include "reduce.hpp"

namespace tact {
namespace {

/// Entries that differ by less than this fraction of the part's largest are the same.
constexpr double same = 1e-14;

[[noreturn]] void reject(const std::string& what) { throw InputError("build_reduced_model: " + what); }

std::vector<Parameter> corners(const Parameter& lower, const Parameter& upper) {
    const Index d = lower.size();
    std::vector<Parameter> points;
    if (d > 8) return {lower, upper};
    for (Index corner = 0; corner < (Index{1} << d); ++corner) {
        Parameter gamma = lower;
        for (Index j = 0; j < d; ++j)
            if ((corner >> j) & 1) gamma[j] = upper[j];
        points.push_back(std::move(gamma));
    }
    return points;
}

Vector entries(const std::string& part, const ContactProblem& p) {
    const auto of = [](const Matrix& A) -> Vector {
        if (const Vector* d = A.diagonal_entries()) return *d;
        return A.to_dense().reshaped();
    };
    if (part == "M") return p.M ? of(*p.M) : Vector();
    if (part == "D") return p.D ? of(*p.D) : Vector();
    if (part == "K") return of(p.K);
    if (part == "B") return of(p.B);
    if (part == "c") return p.c.modes.reshaped();
    if (part == "f") return p.f.modes.reshaped();
    return part == "u0" ? p.u0 : p.v0;
}

/// M, D and K that a modal basis makes diagonal for one gamma only are dense for all.
ContactProblem dense(ContactProblem p) {
    const auto widen = [](Matrix& A) { A = Matrix(A.to_dense()); };
    if (p.M) widen(*p.M);
    if (p.D) widen(*p.D);
    widen(p.K);
    return p;
}

class Builder {
public:
    Builder(const ContactFamily& family, const ReducedBasis& basis, const ReducedModelOptions& options)
        : family_(family),
          basis_(basis),
          options_(options),
          lower_(family.lower()),
          upper_(family.upper()),
          full_(family.at((lower_ + upper_) / 2)) {}

    ReducedModelData run() {
        if (full_.r) reject("the problem has internal forces r, expected none: they live at the full size");
        data_.names = family_.names();
        data_.lower = lower_;
        data_.upper = upper_;
        if (options_.keep_basis) data_.basis = basis_;
        data_.centre = reduce(full_, basis_);
        data_.method = options_.method;
        data_.training = options_.training;
        find_parts();
        if (!data_.parts.empty()) expand_parts();
        if (gap_depends_) expand_gap();
        tabulate_time();
        add_quantities();
        add_checks();
        if (gap_depends_ || !data_.parts.empty()) measure();
        return std::move(data_);
    }

private:
    void find_parts() {
        const std::vector<std::string> varying = family_.varying();
        const auto varies = [&](std::string_view part) {
            return std::find(varying.begin(), varying.end(), part) != varying.end();
        };
        for (const char* part : {"M", "D", "K", "B", "f", "u0", "v0"})
            if (varies(part) && entries(part, data_.centre).size() > 0) data_.parts.emplace_back(part);
        gap_depends_ = varies("c") && data_.centre.constraints() > 0 && !data_.names.empty();
        if (gap_depends_ && !full_.c.constant())
            reject("the gap varies in time and in gamma, expected one of the two");
        if (!data_.names.empty()) probe(varies);
    }

    /// Whether the parts that the family does not name are the same everywhere.
    template <class Varies> void probe(const Varies& varies) const {
        std::vector<Parameter> probes = corners(lower_, upper_);
        const std::vector<Parameter> inside = spread_points(lower_, upper_, 4);
        probes.insert(probes.end(), inside.begin(), inside.end());
        const ContactProblem centre = dense(data_.centre);
        for (const Parameter& gamma : probes) {
            const ContactProblem other = dense(reduce(family_.at(gamma), basis_));
            for (const char* part : {"M", "D", "K", "B", "c", "f", "u0", "v0"}) {
                const Vector a = entries(part, centre), b = entries(part, other);
                if (a.size() != b.size()) reject(std::string(part) + " has another size at another gamma");
                const double difference = a.size() > 0 ? (a - b).lpNorm<Eigen::Infinity>() : 0;
                if (!varies(part) && !(difference <= same * a.lpNorm<Eigen::Infinity>()))
                    reject(std::string(part) +
                           " differs between parameters, expected it among the family's varying()");
            }
        }
    }

    bool depends(std::string_view part) const {
        return std::find(data_.parts.begin(), data_.parts.end(), part) != data_.parts.end();
    }

    /// Empty unless it comes close.
    ChebyshevSeries series(const ParameterFunction& function, Index size) const {
        ChebyshevOptions series = options_.series;
        series.tolerance = options_.tolerance;
        ChebyshevFit fit = fit_chebyshev(function, size, lower_, upper_, series);
        return fit.error <= options_.acceptable ? std::move(fit.series) : ChebyshevSeries();
    }

    std::vector<Parameter> samples() const {
        std::vector<Parameter> points = spread_points(lower_, upper_, options_.samples);
        for (Parameter& corner : corners(lower_, upper_)) points.push_back(std::move(corner));
        return points;
    }

    /// All parts but the gap, one below the other, each in units of its size at the centre.
    void expand_parts() {
        for (const char* part : {"M", "D", "K"})
            if (depends(part)) widen(part);
        std::vector<double> scales;
        for (const std::string& part : data_.parts) {
            const double scale = entries(part, data_.centre).lpNorm<Eigen::Infinity>();
            scales.push_back(scale > 0 ? scale : 1);
        }
        Index size = 0;
        for (const std::string& part : data_.parts) size += entries(part, data_.centre).size();
        const auto stacked = [&](const Parameter& gamma) {
            const ContactProblem problem = dense(reduce(family_.at(gamma), basis_));
            Vector x(size);
            Index from = 0;
            for (std::size_t k = 0; k < data_.parts.size(); ++k) {
                const Vector part = entries(data_.parts[k], problem) / scales[k];
                x.segment(from, part.size()) = part;
                from += part.size();
            }
            return x;
        };
        const std::vector<Parameter> points = samples();
        DenseMatrix X(size, static_cast<Index>(points.size()));
        for (Index j = 0; j < X.cols(); ++j) X.col(j) = stacked(points[static_cast<std::size_t>(j)]);
        if (family_.coefficients(lower_).size() > 0)
            find_terms(points, X);
        else
            interpolate(X, stacked);
        Index from = 0;
        for (std::size_t k = 0; k < data_.parts.size(); ++k) {
            const Index count = entries(data_.parts[k], data_.centre).size();
            data_.others.terms.middleRows(from, count) *= scales[k];
            from += count;
        }
    }

    template <class Stacked> void interpolate(const DenseMatrix& X, const Stacked& stacked) {
        const auto few = interpolate_empirically(X, options_.tolerance, options_.max_terms);
        const ParameterFunction theta = [&](const Parameter& gamma, VectorRef out) {
            out = stacked(gamma)(few.points);
        };
        data_.others.theta = series(theta, few.size());
        if (data_.others.theta.empty())
            reject("no series of " + data_.parts[0] + " over the box of " + std::to_string(lower_.size()) +
                   " parameters comes close; expected a family that tells its coefficients");
        data_.others.terms = few.modes;
    }

    /// The terms that belong to the family's coefficients, by least squares.
    void find_terms(const std::vector<Parameter>& points, const DenseMatrix& X) {
        const Index count = family_.coefficients(lower_).size();
        DenseMatrix theta(X.cols(), count);
        for (Index j = 0; j < X.cols(); ++j)
            theta.row(j) = family_.coefficients(points[static_cast<std::size_t>(j)]).transpose();
        data_.others.terms = theta.colPivHouseholderQr().solve(X.transpose()).transpose();
        const double rest = (data_.others.terms * theta.transpose() - X).cwiseAbs().maxCoeff();
        constexpr double affine = 1e-10;
        if (!(rest <= affine * X.cwiseAbs().maxCoeff()))
            reject("the parts that vary differ by " + shown(rest) +
                   " of their size from sums with the family's coefficients, expected none");
        const ParameterFunction function = [&](const Parameter& gamma, VectorRef out) {
            out = family_.coefficients(gamma);
        };
        data_.others.theta = series(function, count);
        data_.affine = true;
    }

    void widen(std::string_view part) {
        Matrix& A = part == "M" ? *data_.centre.M : part == "D" ? *data_.centre.D : data_.centre.K;
        A = Matrix(A.to_dense());
    }

    /// The gap on the rows that U_lambda touches and those that are checked.
    void expand_gap() {
        std::vector<Index> rows = options_.check_rows;
        for (Index i = 0; i < basis_.U_lambda.rows(); ++i)
            if ((basis_.U_lambda.row(i).array() != 0).any()) rows.push_back(i);
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        const std::vector<Parameter> points = samples();
        DenseMatrix X(static_cast<Index>(rows.size()), static_cast<Index>(points.size()));
        for (Index j = 0; j < X.cols(); ++j) family_.gap(points[static_cast<std::size_t>(j)], rows, X.col(j));
        const auto few = interpolate_empirically(X, options_.tolerance, options_.max_terms);
        for (const Index point : few.points) data_.gap_rows.push_back(rows[static_cast<std::size_t>(point)]);
        const ParameterFunction theta = [&](const Parameter& gamma, VectorRef out) {
            family_.gap(gamma, data_.gap_rows, out);
        };
        data_.gap.theta = series(theta, few.size());
        data_.gap.terms = basis_.U_lambda(rows, Eigen::all).transpose() * few.modes;
        std::vector<Index> checked;
        for (const Index row : options_.check_rows)
            checked.push_back(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
        data_.checks.gap = few.modes(checked, Eigen::all);
    }

    void tabulate_time() {
        if (full_.f.constant() && full_.c.constant()) return;
        if (!(options_.method.grid.dt > 0) || options_.method.grid.steps < 1)
            reject("method.grid has no steps, expected the one on which the load or the gap varies in time");
        data_.load = tabulate(full_.f, options_.method.grid, options_.time_refinement);
        data_.moving = tabulate(full_.c, options_.method.grid, options_.time_refinement);
        // What is stored has to be what is used: the tables, from the first answer on.
        data_.centre.f.coefficients = {};
        data_.centre.c.coefficients = {};
    }

    void add_quantities() {
        const Index count = static_cast<Index>(options_.quantities.size());
        ReducedQuantities& q = data_.quantities;
        q.Q = DenseMatrix::Zero(count, data_.centre.size());
        q.Q_lambda = DenseMatrix::Zero(count, data_.centre.constraints());
        for (Index k = 0; k < count; ++k) {
            const QuantityOfInterest& of = options_.quantities[static_cast<std::size_t>(k)];
            const auto expect = [&](const char* field, const Vector& v, Index size) {
                if (v.size() != 0 && v.size() != size)
                    reject("quantity " + of.name + ": " + field + " is " + std::to_string(v.size()) +
                           "x1, expected " + std::to_string(size) + "x1");
            };
            expect("displacement", of.displacement, full_.size());
            expect("force", of.force, full_.constraints());
            q.names.push_back(of.name);
            if (of.displacement.size() > 0) q.Q.row(k) = of.displacement.transpose() * basis_.U;
            if (of.force.size() > 0 && basis_.dual_size() > 0)
                q.Q_lambda.row(k) = of.force.transpose() * basis_.U_lambda;
        }
    }

    void add_checks() {
        ErrorChecks& checks = data_.checks;
        checks.stride = options_.check_stride;
        checks.rows = options_.check_rows;
        for (const Index row : checks.rows)
            if (row < 0 || row >= full_.constraints()) reject("check_rows holds " + std::to_string(row));
        for (const Index row : options_.check_unknowns)
            if (row < 0 || row >= full_.size()) reject("check_unknowns holds " + std::to_string(row));
        const DenseMatrix& U = basis_.U;
        if (!checks.rows.empty()) {
            checks.B_U = full_.B.times(U)(checks.rows, Eigen::all);
            if (!gap_depends_) checks.gap = full_.c.dense_modes("build_reduced_model: c")(checks.rows, Eigen::all);
        }
        if (options_.check_unknowns.empty() || !data_.parts.empty()) return;
        checks.unknowns = options_.check_unknowns;
        checks.K_U = full_.K.times(U)(checks.unknowns, Eigen::all);
        if (full_.M) checks.M_U = full_.M->times(U)(checks.unknowns, Eigen::all);
        if (full_.D) checks.D_U = full_.D->times(U)(checks.unknowns, Eigen::all);
        checks.load = full_.f.dense_modes("build_reduced_model: f")(checks.unknowns, Eigen::all);
        if (basis_.dual_size() > 0)
            checks.multipliers = full_.B.transposed_times(basis_.U_lambda)(checks.unknowns, Eigen::all);
        else
            checks.multipliers.resize(static_cast<Index>(checks.unknowns.size()), 0);
    }

    void measure() {
        std::vector<std::string> parts = data_.parts;
        if (gap_depends_) parts.emplace_back("c");
        ExactFunctions functions;
        if (data_.gap.theta.empty())
            functions.gap = [this](const Parameter& gamma, std::span<const Index> rows, VectorRef out) {
                family_.gap(gamma, rows, out);
            };
        if (data_.affine && data_.others.theta.empty())
            functions.coefficients = [this](const Parameter& gamma) { return family_.coefficients(gamma); };
        const ReducedModel model(data_, functions);
        for (const Parameter& gamma : spread_points(lower_, upper_, 16)) {
            const ContactProblem exact = reduce(family_.at(gamma), basis_);
            const ContactProblem ours = model.at(gamma);
            for (const std::string& part : parts) {
                const bool matrix = part == "M" || part == "D" || part == "K";
                const Vector a = matrix ? entries(part, dense(exact)) : entries(part, exact);
                const double difference =
                    (a - (matrix ? entries(part, dense(ours)) : entries(part, ours))).lpNorm<Eigen::Infinity>();
                const double scale = a.lpNorm<Eigen::Infinity>();
                data_.parameter_error = std::max(data_.parameter_error, scale > 0 ? difference / scale : difference);
            }
        }
    }

    const ContactFamily& family_;
    const ReducedBasis& basis_;
    const ReducedModelOptions& options_;
    Parameter lower_, upper_;
    ContactProblem full_;
    ReducedModelData data_;
    bool gap_depends_ = false;
};

}  // namespace

ReducedModelData build_reduced_model(const ContactFamily& family, const ReducedBasis& basis,
                                     const ReducedModelOptions& options) {
    return Builder(family, basis, options).run();
}

}  // namespace tact
