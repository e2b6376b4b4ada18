#include <algorithm>
#include <cmath>
#include <vector>

#include "dual_basis.hpp"
#include "dual_basis_input.hpp"
#include "non_negative_least_squares.hpp"

namespace tact {
namespace {

constexpr double gram_resolution = 1e-7;  // of the longest snapshot: distances are roots of differences of squares

/// Snapshots, by their inner products, and the cone of those chosen.
class Cone {
public:
    explicit Cone(DenseMatrix G)
        : G_(std::move(G)), distance_(G_.diagonal().cwiseSqrt()), age_(static_cast<std::size_t>(G_.rows()), 0) {}

    const std::vector<Index>& chosen() const { return chosen_; }
    const Vector& distances() const { return distance_; }

    /// The column farthest from the cone, the first of equals. A cone that has grown is no farther than it was, so only
    /// columns whose last distance is the largest are projected again.
    Index farthest() {
        while (true) {
            Index j = 0;
            distance_.maxCoeff(&j);
            auto& age = age_[static_cast<std::size_t>(j)];
            if (age == chosen_.size()) return j;
            distance_[j] = project(j);
            age = chosen_.size();
        }
    }

    void choose(Index j) {
        chosen_.push_back(j);
        S_ = G_(chosen_, chosen_);
        distance_[j] = 0;
    }

private:
    double project(Index j) const {
        const Vector p = G_(chosen_, j);
        Vector f = Vector::Zero(p.size());
        // A projection cut short only overstates the distance.
        (void)non_negative_least_squares(S_, p, f);
        const double square = G_(j, j) - 2 * p.dot(f) + f.dot(S_ * f);
        return std::min(std::sqrt(std::max(square, 0.0)), distance_[j]);
    }

    DenseMatrix G_, S_;
    Vector distance_;               // of each column, when it was last projected
    std::vector<std::size_t> age_;  // how many were chosen then
    std::vector<Index> chosen_;
};

}  // namespace

DualBasis cone_projected_greedy(double tolerance) {
    return [tolerance](const DualBasisInput& input) {
        const NonNegativeBlock X = checked_snapshots(input);
        DualBasisResult result = empty_dual_basis(input);
        const Index wanted = std::min(input.size, X.cols());
        if (wanted < 1) return result;
        Cone cone(snapshot_gram(input.snapshots, X.column_places()));
        const double longest = cone.distances().maxCoeff();
        while (static_cast<Index>(cone.chosen().size()) < wanted) {
            const Index j = cone.farthest();
            const double distance = cone.distances()[j] / longest;
            if (!(distance > std::max(tolerance, gram_resolution))) break;
            if (!cone.chosen().empty()) result.residuals.push_back(distance);
            cone.choose(j);
            if (report(input, static_cast<double>(cone.chosen().size()) / static_cast<double>(wanted))) continue;
            result.outcome = Outcome::stopped;
            break;
        }
        std::vector<Index> places;
        for (const Index j : cone.chosen()) places.push_back(X.column_places()[static_cast<std::size_t>(j)]);
        result.U_lambda = unit_columns(input.snapshots, places);
        result.warning = decay_warning(X, input.size);
        return result;
    };
}

}  // namespace tact
