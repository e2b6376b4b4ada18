#include "non_negative_least_squares.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace tact {
namespace {

constexpr double dependent_pivot = 1e-11;   // of the diagonal entry: a row that those in use give already
constexpr double rounding_of_pull = 1e-13;  // of |p| + |S||f|: a gradient this small is zero

/// The unknowns in use and the Cholesky factor of their block of S.
class Passive {
public:
    explicit Passive(const DenseMatrix& S) : S_(S) {}

    const std::vector<Index>& members() const { return members_; }
    bool holds(Index j) const { return std::find(members_.begin(), members_.end(), j) != members_.end(); }
    /// Takes j; says whether it is independent of the others, else leaves it out.
    bool add(Index j) {
        members_.push_back(j);
        if (factorize()) return true;
        members_.pop_back();
        factorize();
        return false;
    }
    /// Leaves out those whose f is zero.
    void drop_zeros(const ConstVectorRef& f) {
        std::erase_if(members_, [&](Index j) { return f[j] == 0; });
        factorize();
    }
    bool start(const ConstVectorRef& f) {
        for (Index j = 0; j < f.size(); ++j)
            if (f[j] > 0) members_.push_back(j);
        return factorize();
    }
    void clear() { members_.clear(); }
    /// S_PP^-1 p_P.
    Vector solve(const ConstVectorRef& p) const { return llt_.solve(p(members_)); }

private:
    bool factorize() {
        if (members_.empty()) return true;
        llt_.compute(S_(members_, members_));
        if (llt_.info() != Eigen::Success) return false;
        for (std::size_t k = 0; k < members_.size(); ++k) {
            const double pivot = llt_.matrixLLT()(static_cast<Index>(k), static_cast<Index>(k));
            if (!(pivot * pivot > dependent_pivot * S_(members_[k], members_[k]))) return false;
        }
        return true;
    }
    const DenseMatrix& S_;
    std::vector<Index> members_;
    Eigen::LLT<DenseMatrix> llt_;
};

/// Moves f to the minimum over the unknowns in use, leaving out each that reaches zero on the way.
void descend(Passive& passive, const ConstVectorRef& p, VectorRef f) {
    while (!passive.members().empty()) {
        const Vector z = passive.solve(p);
        double step = 1;
        Index blocking = -1;
        for (std::size_t k = 0; k < passive.members().size(); ++k) {
            const Index j = passive.members()[k];
            const double goal = z[static_cast<Index>(k)];
            if (goal > 0) continue;
            const double to_zero = f[j] > 0 ? f[j] / (f[j] - goal) : 0;
            if (blocking < 0 || to_zero < step) {
                step = to_zero;
                blocking = j;
            }
        }
        for (std::size_t k = 0; k < passive.members().size(); ++k) {
            double& value = f[passive.members()[k]];
            value = blocking < 0 ? z[static_cast<Index>(k)]
                                 : std::max(value + step * (z[static_cast<Index>(k)] - value), 0.0);
        }
        if (blocking < 0) return;
        f[blocking] = 0;
        passive.drop_zeros(f);
    }
}

}  // namespace

Outcome non_negative_least_squares(const DenseMatrix& S, const ConstVectorRef& p, VectorRef f) {
    Passive passive(S);
    if (!passive.start(f)) {
        // A dependent start gives no factor: the minimum is as low from zero.
        passive.clear();
        f.setZero();
    }
    descend(passive, p, f);
    std::vector<bool> refused(static_cast<std::size_t>(f.size()), false);
    const Index limit = 10 * f.size() + 100;
    for (Index iteration = 0; iteration < limit; ++iteration) {
        const Vector pull = p - S * f;
        Index entering = -1;
        double strongest = 0;
        for (Index j = 0; j < f.size(); ++j) {
            if (f[j] > 0 || refused[static_cast<std::size_t>(j)] || !(S(j, j) > 0)) continue;
            const double noise = rounding_of_pull * (std::abs(p[j]) + S.col(j).cwiseAbs().dot(f));
            const double strength = pull[j] / std::sqrt(S(j, j));
            if (pull[j] > noise && strength > strongest) {
                strongest = strength;
                entering = j;
            }
        }
        if (entering < 0) return Outcome::converged;
        if (!passive.add(entering)) {
            refused[static_cast<std::size_t>(entering)] = true;
            continue;
        }
        descend(passive, p, f);
        if (f[entering] > 0)
            std::fill(refused.begin(), refused.end(), false);
        else
            refused[static_cast<std::size_t>(entering)] = true;  // its pull was rounding
    }
    return Outcome::iteration_limit;
}

}  // namespace tact
