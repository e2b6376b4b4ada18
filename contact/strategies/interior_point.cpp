#include "interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "../dense/acceptance.hpp"
#include "saddle_system.hpp"

#include "../../lib/algebra/empty_rows.hpp"

namespace tact {
namespace {

/// Bounds beyond this are ways to write none; a row left out that turns out violated fails the certificate.
constexpr double pseudo_infinite = 1e19;

/// max_i of -x_i / dx_i over falling entries gives the step to the boundary, at most 1.
double step_to_boundary(const Vector& x, const Vector& dx) {
    double step = 1;
    for (Index i = 0; i < x.size(); ++i)
        if (dx[i] < 0) step = std::min(step, -x[i] / dx[i]);
    return step;
}

double size_of(const Vector& x) { return x.lpNorm<Eigen::Infinity>(); }

/// min 1/2 u'Au - u'b with rows that are equations (first) and inequalities, all scaled.
struct Programme {
    const SparseMatrix& A;
    Vector b;
    std::vector<Index> rows;  // of the scaled B: equations, then inequalities
    Index equations = 0;
    SparseMatrix Bt;  // a column each
    Vector c;
    Index inequalities() const { return c.size() - equations; }
};

struct Iterate {
    Vector u, multiplier, slack;  // multipliers of equations have any sign; slack only of the inequalities
};

/// Mehrotra's method. Inequalities with one entry go into the diagonal of A.
class PathFollowing {
public:
    explicit PathFollowing(const Programme& p) : p_(p), system_(p.A, columns_in_system(), 1e-12) {}

    /// The best iterate until the residuals are at rounding or improve no more.
    Iterate run(int& iterations) {
        start();
        Iterate best = at_;
        double least = infinity, reference = infinity;
        int stalled = 0;
        for (iterations = 0; iterations < 300 && stalled < 12; ++iterations) {
            const double merit = residuals();
            if (!std::isfinite(merit)) break;
            if (merit < least) {
                least = merit;
                best = at_;
            }
            ++stalled;
            if (merit < 0.9 * reference) {
                reference = merit;
                stalled = 0;
            }
            if (merit < 1e-13 || !advance()) break;
        }
        return best;
    }

private:
    static constexpr double central = 1e-4;

    SparseMatrix columns_in_system() {
        std::vector<Index> kept;
        for (Index i = 0; i < p_.c.size(); ++i)
            if (i < p_.equations || p_.Bt.col(i).nonZeros() != 1)
                kept.push_back(i);
            else
                bounds_.push_back(i);
        general_.assign(kept.begin() + p_.equations, kept.end());
        SparseMatrix C(p_.A.rows(), static_cast<Index>(kept.size()));
        for (std::size_t k = 0; k < kept.size(); ++k) {
            C.startVec(static_cast<Index>(k));
            for (SparseMatrix::InnerIterator it(p_.Bt, kept[k]); it; ++it)
                C.insertBack(it.row(), static_cast<Index>(k)) = it.value();
        }
        C.finalize();
        return C;
    }
    double& slack(Index row) { return at_.slack[row - p_.equations]; }
    SparseMatrix::InnerIterator bound(Index row) const { return SparseMatrix::InnerIterator(p_.Bt, row); }

    bool factor(const Vector& ratio) {  // lambda / s of the inequalities
        const Index e = p_.equations;
        Vector d = Vector::Zero(p_.A.rows());
        Vector theta = Vector::Zero(e + static_cast<Index>(general_.size()));
        for (const Index i : bounds_) {
            const auto entry = bound(i);
            d[entry.row()] += entry.value() * entry.value() * ratio[i - e];
        }
        for (std::size_t k = 0; k < general_.size(); ++k)
            theta[e + static_cast<Index>(k)] += 1 / ratio[general_[k] - e];
        return system_.factor(d, theta);
    }

    /// A du - B'dl = force;  B du - ds = gap;  s dl + l ds = target (equations: B du = gap).
    void direction(const Vector& force, const Vector& gap, const Vector& target, Iterate& step) {
        const Index e = p_.equations;
        const auto lambda = at_.multiplier.tail(p_.inequalities());
        step.u = force;
        Vector g(e + static_cast<Index>(general_.size()));
        g.head(e) = gap.head(e);
        for (const Index i : bounds_) {
            const auto entry = bound(i);
            step.u[entry.row()] += entry.value() * (target[i - e] + lambda[i - e] * gap[i]) / slack(i);
        }
        for (std::size_t k = 0; k < general_.size(); ++k) {
            const Index i = general_[k];
            g[e + static_cast<Index>(k)] = gap[i] + target[i - e] / lambda[i - e];
        }
        system_.solve(step.u, g);
        step.slack = (p_.Bt.transpose() * step.u - gap).tail(p_.inequalities());
        step.multiplier.resize(p_.c.size());
        step.multiplier.head(e) = g.head(e);
        for (std::size_t k = 0; k < general_.size(); ++k) {
            const Index i = general_[k];
            const double dl = step.multiplier[i] = g[e + static_cast<Index>(k)];
            // B du - gap would cancel.
            if (slack(i) < lambda[i - e]) step.slack[i - e] = (target[i - e] - slack(i) * dl) / lambda[i - e];
        }
        for (const Index i : bounds_)
            step.multiplier[i] = (target[i - e] - lambda[i - e] * step.slack[i - e]) / slack(i);
    }

    void start() {
        const Index e = p_.equations, m = p_.inequalities();
        at_ = {Vector::Zero(p_.A.rows()), Vector::Zero(p_.c.size()), Vector::Ones(m)};
        at_.multiplier.tail(m).setOnes();
        if (!factor(Vector::Ones(m))) return;
        Iterate first;
        Vector force = p_.b, gap = p_.c;
        // With s = lambda = 1 as a reference: B u - c = s and multipliers -s, both shifted to be positive.
        direction(force, gap, Vector::Zero(m), first);
        at_.u = first.u;
        at_.multiplier.head(e) = first.multiplier.head(e);
        if (m == 0) return;
        Vector s = first.slack, lambda = first.multiplier.tail(m);
        const double scale = std::max(size_of(s), 1e-8 * std::max(size_of(first.u), 1e-300));
        s.array() += std::max(-1.5 * s.minCoeff(), 1e-3 * scale);
        lambda.array() += std::max(-1.5 * lambda.minCoeff(), 1e-3 * scale);
        const double product = 0.5 * s.dot(lambda);
        at_.slack = s.array() + product / lambda.sum();
        at_.multiplier.tail(m) = lambda.array() + product / s.sum();
    }

    double residuals() {
        const Index m = p_.inequalities();
        force_ = p_.b - p_.A * at_.u + p_.Bt * at_.multiplier;
        gap_ = p_.c - p_.Bt.transpose() * at_.u;
        gap_.tail(m) += at_.slack;
        const double u = size_of(at_.u), f = std::max({size_of(p_.b), size_of(at_.multiplier), u, 1e-300});
        double worst = size_of(force_) / f;
        for (Index i = 0; i < gap_.size(); ++i)
            worst = std::max(worst, std::abs(gap_[i]) / (std::abs(p_.c[i]) + u + 1e-300));
        mean_ = m == 0 ? 0 : at_.slack.dot(at_.multiplier.tail(m)) / static_cast<double>(m);
        const double largest = m == 0 ? 0 : size_of(at_.multiplier);
        for (Index i = p_.equations; i < gap_.size(); ++i)
            worst =
                std::max(worst, std::min(slack(i) / (std::abs(p_.c[i]) + u + 1e-300), at_.multiplier[i] / largest));
        return worst;
    }

    bool advance() {
        const Index m = p_.inequalities();
        const Vector lambda = at_.multiplier.tail(m);
        if (!factor(lambda.cwiseQuotient(at_.slack))) return false;
        const Vector product = at_.slack.cwiseProduct(lambda);
        Iterate step;
        const auto boundary = [&] {
            return std::min(step_to_boundary(at_.slack, step.slack),
                            step_to_boundary(lambda, step.multiplier.tail(m)));
        };
        // Short of the boundary, and where no product s lambda falls far below the others.
        const auto reach = [&] {
            double a = boundary();
            a = a < 1 ? 0.995 * a : 1;
            for (int k = 0; k < 60; ++k, a *= 0.9) {
                const Vector next = (at_.slack + a * step.slack).cwiseProduct(lambda + a * step.multiplier.tail(m));
                if (next.minCoeff() >= central * next.mean()) break;
            }
            return a;
        };
        direction(force_, gap_, -product, step);
        double length = 1;
        if (m > 0) {
            const Vector dl = step.multiplier.tail(m);
            const double a = boundary();
            const double reached = (at_.slack + a * step.slack).dot(lambda + a * dl) / static_cast<double>(m);
            const double centring = std::pow(std::max(0.0, reached / mean_), 3) * mean_;
            const Vector target = centring - product.array() - step.slack.array() * dl.array();
            direction(force_, gap_, target, step);
            length = reach();
            if (length < 0.1) {  // too near the boundary for large steps: away from it first
                direction(force_, gap_, Vector(0.5 * mean_ - product.array()), step);
                length = reach();
            }
        }
        if (!step.u.allFinite() || !step.multiplier.allFinite()) return false;
        at_.u += length * step.u;
        at_.multiplier += length * step.multiplier;
        at_.slack += length * step.slack;
        return length > 1e-10;
    }

    const Programme& p_;
    std::vector<Index> bounds_, general_;
    SaddleSystem system_;
    Iterate at_;
    Vector force_, gap_;
    double mean_ = 0;
};

/// The set {lambda > s} as equations, and a few rounds of the primal-dual active set from there; false if it does not settle.
bool settle(const Programme& p, Iterate& at) {
    const Index e = p.equations;
    std::vector<char> active(static_cast<std::size_t>(p.inequalities()));
    for (Index i = 0; i < p.inequalities(); ++i)
        active[static_cast<std::size_t>(i)] = at.multiplier[e + i] > at.slack[i];
    for (int round = 0; round < 12; ++round) {
        std::vector<Index> rows;
        for (Index i = 0; i < p.c.size(); ++i)
            if (i < e || active[static_cast<std::size_t>(i - e)]) rows.push_back(i);
        SparseMatrix C(p.A.rows(), static_cast<Index>(rows.size()));
        Vector u = p.b, g(C.cols());
        for (Index k = 0; k < C.cols(); ++k) {
            const Index row = rows[static_cast<std::size_t>(k)];
            C.startVec(k);
            for (SparseMatrix::InnerIterator it(p.Bt, row); it; ++it) C.insertBack(it.row(), k) = it.value();
            g[k] = p.c[row];
        }
        C.finalize();
        SaddleSystem system(p.A, C, 1e-10);
        if (!system.factor(Vector::Zero(p.A.rows()), Vector::Zero(C.cols()))) return false;
        system.solve(u, g);
        if (!u.allFinite() || !g.allFinite()) return false;
        Vector multiplier = Vector::Zero(p.c.size());
        for (Index k = 0; k < C.cols(); ++k) multiplier[rows[static_cast<std::size_t>(k)]] = g[k];
        const Vector gap = p.Bt.transpose() * u - p.c;
        const double noise = 1e-13 * size_of(g), reach = size_of(u);
        bool settled = true;
        for (Index i = 0; i < p.inequalities(); ++i) {
            char& on = active[static_cast<std::size_t>(i)];
            const bool right = on ? multiplier[e + i] > -noise : gap[e + i] > -1e-13 * (std::abs(p.c[e + i]) + reach);
            if (right) continue;
            on ^= 1;
            settled = false;
        }
        if (!settled) continue;
        at.u = u;
        at.multiplier = multiplier;
        return true;
    }
    return false;
}

class PreparedInterior final : public PreparedContact {
public:
    PreparedInterior(const Matrix& A, const Matrix& B, std::shared_ptr<const ContactSolver> finish)
        : source_A_(A), source_B_(B), finish_(std::move(finish)), accept_(A, B) {
        unit_ = A.main_diagonal().cwiseSqrt().cwiseInverse();
        A_ = unit_.asDiagonal() * A.to_sparse() * unit_.asDiagonal();
        Bt_ = B.to_sparse().transpose();
        mirror_ = mirrored_rows();
        scaled_Bt_ = unit_.asDiagonal() * Bt_;
        length_.resize(B.rows());
        for (Index i = 0; i < B.rows(); ++i) {
            const double norm = scaled_Bt_.col(i).norm();
            length_[i] = norm > 0 ? 1 / norm : 1;
        }
        scaled_Bt_ = scaled_Bt_ * length_.asDiagonal();
    }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "interior point";
        if (!b.allFinite() || !(c.array() < infinity).all()) {
            report.outcome = Outcome::inaccurate;
            return report;
        }
        Programme p{A_, unit_.cwiseProduct(b), {}, 0, {}, {}};
        if (!sort_rows(c, p, report)) return report;
        Iterate at = PathFollowing(p).run(report.iterations);
        Iterate set = at;
        const bool settled = settle(p, set);
        if (settled) accept(report, p, set, b, c, point);
        if (!settled || report.outcome != Outcome::converged) {
            report.outcome = Outcome::converged;
            accept(report, p, at, b, c, point);
        }
        if (report.outcome == Outcome::converged || !finish_) return report;
        return finish(report, b, c, point);
    }

private:
    static constexpr double acceptable = 1e-10;

    /// For each row the row that is its negative, -1 where there is none.
    std::vector<Index> mirrored_rows() const {
        std::vector<Index> mirror(static_cast<std::size_t>(Bt_.cols()), -1);
        std::map<std::vector<std::pair<long, double>>, Index> seen;
        for (Index i = 0; i < Bt_.cols(); ++i) {
            std::vector<std::pair<long, double>> row, negative;
            for (SparseMatrix::InnerIterator it(Bt_, i); it; ++it) {
                row.emplace_back(it.row(), it.value());
                negative.emplace_back(it.row(), -it.value());
            }
            if (const auto other = seen.find(negative); other != seen.end()) {
                mirror[static_cast<std::size_t>(i)] = other->second;
                mirror[static_cast<std::size_t>(other->second)] = i;
                seen.erase(other);
            } else {
                seen.emplace(std::move(row), i);
            }
        }
        return mirror;
    }

    /// Equations, then inequalities; false where two mirrored rows exclude each other.
    bool sort_rows(const ConstVectorRef& c, Programme& p, ContactReport& report) {
        std::vector<Index> open;
        for (Index i = 0; i < c.size(); ++i) {
            if (c[i] <= -pseudo_infinite) continue;
            const Index j = mirror_[static_cast<std::size_t>(i)];
            const double excess = j < 0 ? -infinity : c[i] + c[j];
            if (j >= 0 && excess >= -1e-15 * std::abs(c[i])) {
                if (excess > 1e-12 * std::abs(c[i])) {
                    report.outcome = Outcome::infeasible;
                    report.infeasibility = Vector::Zero(c.size());
                    report.infeasibility[i] = report.infeasibility[j] = 1;
                    return false;
                }
                if (i < j) p.rows.push_back(i);
            } else {
                open.push_back(i);
            }
        }
        p.equations = static_cast<Index>(p.rows.size());
        p.rows.insert(p.rows.end(), open.begin(), open.end());
        p.c.resize(static_cast<Index>(p.rows.size()));
        p.Bt.resize(A_.rows(), p.c.size());
        for (Index k = 0; k < p.c.size(); ++k) {
            const Index row = p.rows[static_cast<std::size_t>(k)];
            p.c[k] = c[row] * length_[row];
            p.Bt.startVec(k);
            for (SparseMatrix::InnerIterator it(scaled_Bt_, row); it; ++it) p.Bt.insertBack(it.row(), k) = it.value();
        }
        p.Bt.finalize();
        return true;
    }

    /// Back in the user's units, certified.
    void accept(ContactReport& report, const Programme& p, const Iterate& at, const ConstVectorRef& b,
                const ConstVectorRef& c, ContactPoint point) {
        u_ = unit_.cwiseProduct(at.u);
        lambda_ = Vector::Zero(c.size());
        const double negligible = 1e-12 * size_of(at.multiplier);
        for (Index k = 0; k < p.c.size(); ++k) {
            const Index row = p.rows[static_cast<std::size_t>(k)];
            // What the path leaves on a row without contact is nothing.
            const bool open = k >= p.equations && at.multiplier[k] < std::min(at.slack[k - p.equations], negligible);
            const double multiplier = open ? 0 : at.multiplier[k] * length_[row];
            if (multiplier > 0)
                lambda_[row] = multiplier;
            else if (k < p.equations)
                lambda_[mirror_[static_cast<std::size_t>(row)]] = -multiplier;
            // A bound is met exactly: a gap of zero then is zero, not rounding.
            if (lambda_[row] > 0 && Bt_.col(row).nonZeros() == 1) {
                const SparseMatrix::InnerIterator entry(Bt_, row);
                if (k < p.equations || at.multiplier[k] > at.slack[k - p.equations])
                    u_[entry.index()] = c[row] / entry.value();
            }
        }
        if (works_balance(p, at))
            accept_.certify(report, b, c, u_, lambda_, acceptable, 0, point);
        else
            report.outcome = Outcome::inaccurate;
    }

    /// u'Au = b'u + lambda'c. Where rows nearly exclude each other the path runs off to forces so large that no residual
    /// scaled by them shows anything.
    bool works_balance(const Programme& p, const Iterate& at) const {
        const double energy = at.u.dot(p.A * at.u), load = size_of(p.b);
        const double difference = energy - p.b.dot(at.u) - p.c.dot(at.multiplier);
        const double size = energy + p.b.cwiseProduct(at.u).lpNorm<1>() + p.c.cwiseProduct(at.multiplier).lpNorm<1>();
        return std::abs(difference) <= 1e-6 * size + 1e-13 * load * load;
    }

    ContactReport finish(const ContactReport& first, const ConstVectorRef& b, const ConstVectorRef& c,
                         ContactPoint point) {
        if (!finisher_) finisher_ = finish_->prepare(source_A_, source_B_);
        const double floor = 1e-9 * size_of(lambda_);
        Vector u = point.u;
        Vector guess = lambda_.allFinite() ? Vector((lambda_.array() > floor).select(lambda_, 0.0))
                                           : Vector(Vector::Zero(c.size()));
        ContactReport report = finisher_->solve(b, c, {u, guess});
        report.fallback = report.strategy;
        report.strategy = first.strategy;
        report.iterations += first.iterations;
        if (report.outcome == Outcome::converged) {
            point.u = u;
            point.lambda = guess;
        }
        return report;
    }

    Matrix source_A_, source_B_;
    std::shared_ptr<const ContactSolver> finish_;
    std::unique_ptr<PreparedContact> finisher_;
    Acceptance accept_;
    Vector unit_, length_;  // of an unknown of unit stiffness, of a row of unit length
    SparseMatrix A_, Bt_, scaled_Bt_;
    std::vector<Index> mirror_;
    Vector u_, lambda_;
};

}  // namespace

InteriorPoint::InteriorPoint(std::shared_ptr<const ContactSolver> finish) : finish_(std::move(finish)) {}

std::unique_ptr<PreparedContact> InteriorPoint::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("InteriorPoint", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    if (!A.is_symmetric()) throw InputError("InteriorPoint: A is " + A.shape() + " and not symmetric");
    if (!(A.main_diagonal().array() > 0).all())
        throw InputError("InteriorPoint: A has a diagonal entry <= 0, expected positive definite");
    return std::make_unique<PreparedInterior>(A, B, finish_);
}

}  // namespace tact
