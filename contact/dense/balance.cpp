#include "balance.hpp"

#include <Eigen/QR>
#include <algorithm>

namespace tact {
namespace {

Vector least_squares(const DenseMatrix& G, const std::vector<Index>& rows, const Vector& e) {
    return DenseMatrix(G(rows, Eigen::all)).transpose().colPivHouseholderQr().solve(e);
}

}  // namespace

Balance balance(const DenseMatrix& G, const Vector& e) {
    constexpr double rounding = 1e-14;
    Balance b{{}, Vector(0), e};
    const Vector length = G.rowwise().norm();
    std::vector<char> refused(static_cast<std::size_t>(G.rows()), 0);
    const Index limit = 3 * G.rows() + 100;
    for (Index step = 0; step < limit; ++step) {
        const Vector pull = G * b.rest;
        Index enters = -1;
        double most = 0;
        for (Index i = 0; i < G.rows(); ++i) {
            if (refused[static_cast<std::size_t>(i)] || !(pull[i] > rounding * length[i] * e.norm())) continue;
            if (std::find(b.rows.begin(), b.rows.end(), i) != b.rows.end() || !(pull[i] > most * length[i])) continue;
            most = pull[i] / length[i];
            enters = i;
        }
        if (enters < 0) break;
        std::vector<Index> rows = b.rows;
        rows.push_back(enters);
        Vector lambda(b.lambda.size() + 1);
        lambda << b.lambda, 0;
        while (!rows.empty()) {
            const Vector wanted = least_squares(G, rows, e);
            double part = 1;
            std::size_t leaves = rows.size();
            for (std::size_t k = 0; k < rows.size(); ++k) {
                const auto i = static_cast<Index>(k);
                if (wanted[i] > 0) continue;
                const double until = lambda[i] > 0 ? lambda[i] / (lambda[i] - wanted[i]) : 0;
                if (leaves == rows.size() || until < part) {
                    part = until;
                    leaves = k;
                }
            }
            if (leaves == rows.size()) {
                lambda = wanted;
                break;
            }
            lambda += part * (wanted - lambda);
            const auto i = static_cast<Index>(leaves);
            for (Index k = i; k + 1 < lambda.size(); ++k) lambda[k] = lambda[k + 1];
            lambda.conservativeResize(lambda.size() - 1);
            rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(leaves));
        }
        const bool entered = std::find(rows.begin(), rows.end(), enters) != rows.end();
        const Vector rest = rows.empty() ? e : Vector(e - G(rows, Eigen::all).transpose() * lambda);
        // Rounding alone drew it in: the rest is no smaller.
        if (!entered || !(rest.norm() < b.rest.norm())) {
            refused[static_cast<std::size_t>(enters)] = 1;
            continue;
        }
        std::fill(refused.begin(), refused.end(), 0);
        b = {std::move(rows), std::move(lambda), rest};
    }
    return b;
}

bool complete(const DenseMatrix& G, std::vector<Index>& rows) {
    constexpr double none = 1e-10;
    DenseMatrix left = G;  // of each row, what those taken do not span
    const auto take = [&left](Index row) {
        const Vector direction = left.row(row).transpose().normalized();
        for (int pass = 0; pass < 2; ++pass) left -= (left * direction) * direction.transpose();
    };
    for (const Index row : rows) take(row);
    double best_held = 0;
    while (static_cast<Index>(rows.size()) < G.cols()) {
        Index best = 0;
        const double length = G.rows() > 0 ? left.rowwise().norm().maxCoeff(&best) : 0;
        best_held = std::max(best_held, G.rows() > 0 ? G.rowwise().norm().maxCoeff() : 0);
        if (!(length > none * best_held)) return false;
        take(best);
        rows.push_back(best);
    }
    return true;
}

}  // namespace tact
