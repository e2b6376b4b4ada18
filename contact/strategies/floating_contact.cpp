#include "floating_contact.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/algebra/extended_sums.hpp"
#include "../dense/acceptance.hpp"
#include "../dense/balance.hpp"
#include "../dense/saddle_active_set.hpp"
#include "../prepare/rows.hpp"
#include "../prepare/soft_modes.hpp"

namespace tact {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

/// Rows up to which the compliance of all of them is formed at once: 18 MB.
constexpr Index few_rows = 1500;
/// Rows beyond which there is no dense saddle: a gigabyte.
constexpr Index most_rows = 8000;

class PreparedFloating final : public PreparedContact {
public:
    PreparedFloating(const Matrix& A, const Matrix& B)
        : accept_(A, B),
          modes_(A, B, B.rows() > few_rows ? std::vector<Index>{} : unknowns_in_rows(B, 2 * few_rows)),
          rows_(scaled_rows(B, modes_.unit())),
          source_rows_(B.to_sparse().transpose()),
          all_G_(rows_.transpose() * modes_.R()),
          length_(B.rows()),
          place_(at(B.rows()), -1) {
        for (Index i = 0; i < length_.size(); ++i) length_[i] = rows_.col(i).norm();
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "floating body";
        report.outcome = Outcome::inaccurate;
        if (!b.allFinite() || c.array().isNaN().any() || (c.array() == infinity).any()) return report;
        lambda_ = point.lambda;
        report.outcome = solve_scaled(modes_.unit().cwiseProduct(b), c, report);
        if (report.outcome == Outcome::unbounded) {
            // What can fall for ever must first be possible at all.
            ContactReport without_load;
            lambda_.setZero();
            if (solve_scaled(Vector::Zero(b.size()), c, without_load) == Outcome::infeasible) {
                report.outcome = Outcome::infeasible;
                report.ray.resize(0);
                report.infeasibility = without_load.infeasibility;
            }
        }
        if (report.outcome == Outcome::infeasible && !accept_.excludes(report.infeasibility, c)) {
            report.infeasibility.resize(0);
            report.outcome = Outcome::inaccurate;
        }
        if (report.infeasibility.size() > 0) report.infeasibility /= report.infeasibility.maxCoeff();
        if (report.outcome != Outcome::converged) return report;
        u_ = modes_.unit().cwiseProduct(x_);
        // A bound is met exactly: a gap of zero then is zero, not rounding.
        for (Index i = 0; i < c.size(); ++i)
            if (lambda_[i] > 0 && source_rows_.col(i).nonZeros() == 1) {
                const SparseMatrix::InnerIterator entry(source_rows_, i);
                u_[entry.index()] = c[i] / entry.value();
            }
        accept_.certify(report, b, c, u_, lambda_, acceptable, reach_, point);
        return report;
    }

private:
    static constexpr double acceptable = 1e-10;
    static constexpr double gap_tolerance = 2e-14;     // of the row's own |c_i| + |B_i||x|
    static constexpr double rounding_of_gaps = 4e-15;  // of the largest of them, in units of energy
    static constexpr double balanced = 1e-12;          // of the terms of a mode's balance
    static constexpr double unbalanced = 1e-11;        // the same for what no row can take
    static constexpr double held = 1e-10;              // of the motion that rows hold best

    /// x_ and lambda_ of the problem in unknowns of unit stiffness; lambda_ is the guess on entry.
    Outcome solve_scaled(const Vector& given, const ConstVectorRef& c, ContactReport& report) {
        load_ = given;
        arrange(c);
        for (Index i = 0; i < c.size(); ++i)
            if (length_[i] == 0 && c[i] > 0) {
                report.infeasibility = Vector::Unit(c.size(), i);
                return Outcome::infeasible;
            }
        if (!take_off_what_nothing_holds(report)) return Outcome::unbounded;
        fill_pool(c);
        free_ = load_;
        solve_stiff(free_);
        reach_ = free_.lpNorm<Eigen::Infinity>();
        for (;;) {
            if (static_cast<Index>(pool_.size()) > most_rows) return Outcome::iteration_limit;
            const Outcome end = solve_pool(c, report);
            if (end != Outcome::converged) return end;
            if (!widen(c)) break;
        }
        return refine(c) ? Outcome::converged : Outcome::inaccurate;
    }

    /// The modes as the rows that are on take part in them: those without stiffness that no row touches, and the others,
    /// of a size at which their compliance is that of the rows.
    void arrange(const ConstVectorRef& c) {
        std::vector<char> on(at(c.size()));
        for (Index i = 0; i < c.size(); ++i) on[at(i)] = c[i] != -infinity && length_[i] > 0;
        if (arranged_ && on == on_) return;
        arranged_ = true;
        on_ = std::move(on);
        const Index n = rows_.rows(), k = modes_.stiffness().size(), free = modes_.free();
        DenseMatrix touched = DenseMatrix::Zero(c.size() + free, free);  // at least as many rows as columns
        for (Index i = 0; i < c.size(); ++i)
            if (on_[at(i)]) touched.row(i) = all_G_.row(i).head(free) / length_[i];
        Index taking_part = 0;
        DenseMatrix turn = DenseMatrix::Identity(free, free);
        if (free > 0) {
            const Eigen::HouseholderQR<DenseMatrix> qr(touched);
            const DenseMatrix triangle = qr.matrixQR().topRows(free).triangularView<Eigen::Upper>();
            const Eigen::JacobiSVD<DenseMatrix> svd(triangle, Eigen::ComputeFullV);
            const auto& values = svd.singularValues();
            taking_part = (values.array() > held * std::max(values[0], 1e-300)).count();
            if (taking_part > 0 && taking_part < free) turn = svd.matrixV();
        }
        loose_ = modes_.R().leftCols(free) * turn.rightCols(free - taking_part);
        R_.resize(n, taking_part + k - free);
        R_ << modes_.R().leftCols(free) * turn.leftCols(taking_part), modes_.R().rightCols(k - free);
        G_ = rows_.transpose() * R_;
        stiffness_.setZero(R_.cols());
        stiffness_.tail(k - free) = modes_.stiffness().tail(k - free);
        faint_.setZero(R_.cols(), R_.cols());
        faint_.topLeftCorner(taking_part, taking_part) =
            turn.leftCols(taking_part).transpose() * modes_.faint().asDiagonal() * turn.leftCols(taking_part);
        pool_.clear();
        std::fill(place_.begin(), place_.end(), -1);
        compliance_.resize(0, 0);
        scaled_ = false;
        active_set_.forget();
    }

    /// Modes that compare with the compliance of the rows: the sum of squares of their entries in G is its trace.
    void scale_modes() {
        const Index m = static_cast<Index>(pool_.size());
        const double trace = compliance_.diagonal().head(m).sum();
        for (Index j = 0; j < R_.cols(); ++j) {
            const double size = G_(pool_, j).norm();
            if (!(size > 0) || !(trace > 0)) continue;
            const double factor = std::sqrt(trace) / size;
            R_.col(j) *= factor;
            G_.col(j) *= factor;
            stiffness_[j] *= factor * factor;
            faint_.row(j) *= factor;
            faint_.col(j) *= factor;
        }
        scaled_ = true;
    }

    /// False, with a ray, where the load drives a motion that no row takes part in.
    bool take_off_what_nothing_holds(ContactReport& report) {
        if (loose_.cols() == 0) return true;
        const Vector size = size_of_balance(loose_, load_);
        Vector force(loose_.cols());
        for (Index j = 0; j < loose_.cols(); ++j) force[j] = extended_dot(loose_.col(j), load_);
        if ((force.array().abs() > unbalanced * size.array()).any()) {
            set_ray(report, loose_ * force);
            return false;
        }
        if ((force.array() != 0).any()) load_ -= loose_ * (loose_.transpose() * loose_).llt().solve(force);
        return true;
    }

    /// The terms of R'load. Where a mode does not move what is loaded its entries there are rounding, 1e-13 of the largest.
    static Vector size_of_balance(const DenseMatrix& R, const Vector& load) {
        const Vector largest = R.cwiseAbs().colwise().maxCoeff().transpose();
        return R.cwiseAbs().transpose() * load.cwiseAbs() + 1e-13 / unbalanced * load.lpNorm<1>() * largest;
    }

    void set_ray(ContactReport& report, const Vector& x) {
        report.ray = modes_.unit().cwiseProduct(x);
        report.ray /= report.ray.lpNorm<Eigen::Infinity>();
    }

    /// x := P x, with springs of unit stiffness on the modes besides: (1 + stiffness)^-1 R'x of each.
    void solve_stiff(Vector& x) const {
        const Vector share = (R_.transpose() * x).cwiseQuotient(Vector(stiffness_.array() + 1));
        modes_.solve(x);
        x += R_ * share;
    }

    void fill_pool(const ConstVectorRef& c) {
        std::vector<Index> fresh;
        const bool all = c.size() <= few_rows;
        for (Index i = 0; i < c.size(); ++i)
            if (on_[at(i)] && (all || lambda_[i] > 0) && place_[at(i)] < 0) fresh.push_back(i);
        if (!all && pool_.empty()) {
            // Rows that take up the load and hold every mode: without them there is no solution on the pool.
            std::vector<Index> on;
            for (Index i = 0; i < c.size(); ++i)
                if (on_[at(i)]) on.push_back(i);
            const DenseMatrix G = length_(on).cwiseInverse().asDiagonal() * G_(on, free_columns());
            std::vector<Index> holding =
                balance(G, Vector(-(R_(Eigen::all, free_columns()).transpose() * load_))).rows;
            (void)complete(G, holding);
            for (const Index k : holding)
                if (std::find(fresh.begin(), fresh.end(), on[at(k)]) == fresh.end()) fresh.push_back(on[at(k)]);
        }
        add(fresh);
    }
    std::vector<Index> free_columns() const {
        std::vector<Index> columns;
        for (Index j = 0; j < stiffness_.size(); ++j)
            if (stiffness_[j] == 0) columns.push_back(j);
        return columns;
    }

    void add(const std::vector<Index>& fresh) {
        if (fresh.empty() && scaled_) return;
        const auto old = static_cast<Index>(pool_.size());
        for (const Index i : fresh) {
            place_[at(i)] = static_cast<Index>(pool_.size());
            pool_.push_back(i);
        }
        const auto m = static_cast<Index>(pool_.size());
        if (compliance_.rows() < m) {
            const Index capacity = old == 0 ? m : m + m / 2;
            compliance_.conservativeResize(capacity, capacity);
            S_.conservativeResize(capacity, capacity);
        }
        SparseMatrix columns(rows_.rows(), m);
        for (Index j = 0; j < m; ++j) {
            columns.startVec(j);
            for (SparseMatrix::InnerIterator it(rows_, pool_[at(j)]); it; ++it)
                columns.insertBack(it.row(), j) = it.value();
        }
        columns.finalize();
        modes_.compliance(columns, old, compliance_);
        if (!scaled_) scale_modes();
        // Rows of unit energy, with springs of unit stiffness on the modes.
        const DenseMatrix G = G_(pool_, Eigen::all);
        const DenseMatrix X = Vector((stiffness_.array() + 1).inverse()).asDiagonal() * G.transpose();
        scale_.conservativeResize(m);
        for (Index j = old; j < m; ++j) {
            S_.col(j).head(j + 1) = compliance_.col(j).head(j + 1) + G.topRows(j + 1) * X.col(j);
            scale_[j] = S_(j, j) > 0 ? 1 / std::sqrt(S_(j, j)) : 1;
            S_.col(j).head(j + 1) = S_.col(j).head(j + 1).cwiseProduct(scale_.head(j + 1)) * scale_[j];
            S_.row(j).head(j) = S_.col(j).head(j).transpose();
        }
        pool_G_ = scale_.asDiagonal() * G;
    }

    struct Question {
        Vector g, e, e_size, allowance, stiffness;
    };
    void ask(const Vector& load, Question& q) const {
        q.e.resize(R_.cols());
        for (Index j = 0; j < R_.cols(); ++j) q.e[j] = -extended_dot(R_.col(j), load);
        q.e_size = size_of_balance(R_, load);
        q.stiffness = stiffness_.array() * (stiffness_.array() + 1);
    }

    Outcome solve_pool(const ConstVectorRef& c, ContactReport& report) {
        const auto m = static_cast<Index>(pool_.size());
        Question q;
        ask(load_, q);
        q.g.resize(m);
        q.allowance.resize(m);
        Vector multiplier(m), tau, w;
        for (Index k = 0; k < m; ++k) {
            const Index row = pool_[at(k)];
            double gap = 0, size = std::abs(c[row]);
            for (SparseMatrix::InnerIterator it(rows_, row); it; ++it) {
                gap += it.value() * free_[it.row()];
                size += std::abs(it.value() * free_[it.row()]);
            }
            q.g[k] = scale_[k] * (c[row] - gap);
            q.allowance[k] = scale_[k] * gap_tolerance * size;
            multiplier[k] = lambda_[row] / scale_[k];
        }
        // The point carries the rounding of its largest entry everywhere.
        if (m > 0) q.allowance.array() += rounding_of_gaps * q.g.lpNorm<Eigen::Infinity>();
        const SaddleActiveSet::Problem problem{S_, pool_G_, q.stiffness, q.e, q.e_size, q.g, q.allowance};
        const auto dense = active_set_.solve(problem, multiplier, tau, w);
        report.iterations += dense.iterations;
        if (dense.repeated) {
            report.set_repeated = true;
            report.fallback = "dual active set";
        }
        lambda_.setZero();
        if (dense.outcome == Outcome::unbounded) set_ray(report, R_ * active_set_.ray());
        if (dense.outcome == Outcome::infeasible) {
            report.infeasibility = Vector::Zero(c.size());
            for (Index k = 0; k < m; ++k)
                report.infeasibility[pool_[at(k)]] = active_set_.infeasibility()[k] * scale_[k];
        }
        if (dense.outcome != Outcome::converged) return dense.outcome;
        for (Index k = 0; k < m; ++k) lambda_[pool_[at(k)]] = multiplier[k] * scale_[k];
        tau_ = tau;
        x_ = rows_ * lambda_;
        modes_.solve(x_);
        // With the springs on the modes undone: t = R'(load + B'lambda) / (1 + stiffness) + tau = (1 + stiffness) tau.
        Vector stiff = load_;
        modes_.solve(stiff);
        x_ += stiff + R_ * tau.cwiseProduct(Vector(stiffness_.array() + 1));
        return Outcome::converged;
    }

    /// Rows outside the pool that are violated come into it; whether there are any.
    bool widen(const ConstVectorRef& c) {
        if (pool_.size() == at(c.size())) return false;
        std::vector<std::pair<double, Index>> violated;
        for (Index i = 0; i < c.size(); ++i) {
            if (!on_[at(i)] || place_[at(i)] >= 0) continue;
            double gap = -c[i], size = std::abs(c[i]);
            for (SparseMatrix::InnerIterator it(rows_, i); it; ++it) {
                gap += it.value() * x_[it.row()];
                size += std::abs(it.value() * x_[it.row()]);
            }
            if (gap < -gap_tolerance * size) violated.emplace_back(gap / length_[i], i);
        }
        std::sort(violated.begin(), violated.end());
        violated.resize(std::min(violated.size(), std::max<std::size_t>(64, pool_.size())));
        std::vector<Index> fresh;
        for (const auto& [gap, i] : violated) fresh.push_back(i);
        if (!fresh.empty()) add(fresh);
        return !fresh.empty();
    }

    /// What is left of each force, from the data in twice the precision.
    Vector residual() const {
        ExtendedSums sums;
        sums.start(load_);
        sums.add(modes_.A(), false, -1, x_);
        for (Index i = 0; i < lambda_.size(); ++i)
            if (lambda_[i] > 0)
                for (SparseMatrix::InnerIterator it(rows_, i); it; ++it) sums.add(it.row(), it.value(), lambda_[i]);
        Vector r;
        sums.end(r);
        return r;
    }

    /// Iterative refinement on the rows in contact. Whether the forces along each mode then cancel: a residual that is small
    /// in each entry says little about their sum.
    bool refine(const ConstVectorRef& c) {
        double last = infinity;
        Vector r = residual();
        for (int pass = 0; pass < 3; ++pass) {
            const double size = r.lpNorm<Eigen::Infinity>();
            const double imbalance = worst_imbalance(r);
            if (size == 0 || (!(size < 0.1 * last) && imbalance <= 1)) break;
            last = size;
            const Vector x = x_, lambda = lambda_, tau = tau_;
            const double before = worst_violation(c);
            correct(r, c);
            if (!(worst_violation(c) <= 10 * before + rounding_of_gaps * x.lpNorm<Eigen::Infinity>())) {
                x_ = x;
                lambda_ = lambda;
                tau_ = tau;
                break;
            }
            r = residual();
        }
        return (load_.isZero(0) && lambda_.isZero(0)) || worst_imbalance(r) <= 1;  // else the certificate sees A x
    }

    double worst_violation(const ConstVectorRef& c) const {
        double worst = 0;
        const Vector gap = rows_.transpose() * x_ - c;
        for (Index i = 0; i < c.size(); ++i)
            if (on_[at(i)]) worst = std::max(worst, -gap[i] / length_[i]);
        return x_.allFinite() ? worst : infinity;
    }

    /// Of the forces along each mode, in what is allowed of them. What A's rounding leaves of a stiffness that is none has a
    /// force, which nobody knows.
    double worst_imbalance(const Vector& r) const {
        constexpr double rounding = std::numeric_limits<double>::epsilon();
        const Vector force = rows_ * lambda_;
        const Vector sizes = size_of_balance(R_, load_) + R_.cwiseAbs().transpose() * force.cwiseAbs() +
                             stiffness_.cwiseProduct(tau_.cwiseAbs());
        const Vector unknown =
            8 * faint_.cwiseAbs() * tau_.cwiseAbs() + 64 * rounding * R_.cwiseAbs().transpose() * r.cwiseAbs();
        double worst = 0;
        for (Index j = 0; j < R_.cols(); ++j) {
            const double rest = std::abs(extended_dot(R_.col(j), r));
            if (rest != 0) worst = std::max(worst, rest / (balanced * sizes[j] + unknown[j]));
        }
        return r.allFinite() ? worst : infinity;
    }

    void correct(const Vector& r, const ConstVectorRef& c) {
        Vector moved = r;
        solve_stiff(moved);
        const auto m = static_cast<Index>(pool_.size());
        Question q;
        ask(r, q);
        q.g.setZero(m);
        ExtendedSums sums;
        for (Index k = 0; k < m; ++k) {
            const Index row = pool_[at(k)];
            if (!(lambda_[row] > 0)) continue;
            Vector gap;
            sums.start(Vector::Constant(1, c[row]));
            for (SparseMatrix::InnerIterator it(rows_, row); it; ++it) sums.add(0, -it.value(), x_[it.row()]);
            sums.end(gap);
            q.g[k] = scale_[k] * (gap[0] - rows_.col(row).dot(moved));
        }
        Vector correction, tau;
        const SaddleActiveSet::Problem problem{S_, pool_G_, q.stiffness, q.e, q.e_size, q.g, q.allowance};
        active_set_.solve_on_last_rows(problem, correction, tau);
        Vector change = Vector::Zero(lambda_.size());
        for (Index k = 0; k < m; ++k)
            if (const Index row = pool_[at(k)]; lambda_[row] > 0) change[row] = correction[k] * scale_[k];
        Vector shift = rows_ * change + r;
        modes_.solve(shift);
        shift += R_ * tau.cwiseProduct(Vector(stiffness_.array() + 1));
        if (!shift.allFinite()) return;
        x_ += shift;
        tau_ += tau;
        lambda_ = (lambda_ + change).cwiseMax(0.0);
    }

    Acceptance accept_;
    SoftModes modes_;
    SparseMatrix rows_, source_rows_;  // column i: row i of B, in unknowns of unit stiffness and as given
    DenseMatrix all_G_;
    Vector length_, stiffness_, scale_;
    bool arranged_ = false, scaled_ = false;
    double reach_ = 0;
    std::vector<char> on_;  // rows with a bound
    DenseMatrix loose_;     // modes without stiffness that no such row takes part in
    DenseMatrix R_, G_;     // the other modes, and B R
    DenseMatrix faint_;     // R'A R of those without stiffness, to A's last digits
    std::vector<Index> pool_, place_;
    DenseMatrix compliance_, S_, pool_G_;
    SaddleActiveSet active_set_;
    Vector load_, free_, x_, u_, lambda_, tau_;
};

}  // namespace

std::unique_ptr<PreparedContact> FloatingContact::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("FloatingContact", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    if (!A.is_symmetric()) throw InputError("FloatingContact: A is " + A.shape() + " and not symmetric");
    return std::make_unique<PreparedFloating>(A, B);
}

}  // namespace tact
