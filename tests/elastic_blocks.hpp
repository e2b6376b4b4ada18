// Linear elastic blocks of squares or cubes with linear shape functions: K, M, and loads for the tests of contact.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <vector>

#include "../lib/problem/matrix.hpp"

namespace tact::test {

/// A block of cells[0] x cells[1] (x cells[2]) squares (cubes) of side h, nodes numbered along x first, their unknowns
/// together. E = 1, nu = .3, rho = 1; plane strain in 2-D.
class ElasticBlock {
public:
    ElasticBlock(int dimension, std::array<int, 3> cells, double h) : dimension_(dimension), cells_(cells), h_(h) {
        if (dimension == 2) cells_[2] = 0;
        assemble();
    }

    Index size() const { return dimension_ * nodes(); }
    Index nodes() const { return along(0) * along(1) * along(2); }
    Index node(int x, int y, int z = 0) const { return (z * along(1) + y) * along(0) + x; }
    Index unknown(Index node, int direction) const { return node * dimension_ + direction; }
    const SparseMatrix& K() const { return K_; }
    const SparseMatrix& M() const { return M_; }

    /// Place of a node, in a box that begins at the origin.
    std::array<double, 3> place(Index node) const {
        const Index x = node % along(0), y = node / along(0) % along(1), z = node / (along(0) * along(1));
        return {h_ * static_cast<double>(x), h_ * static_cast<double>(y), h_ * static_cast<double>(z)};
    }

    /// The nodes at the lowest (highest) end of the last direction.
    std::vector<Index> bottom() const { return face(0); }
    std::vector<Index> top() const { return face(cells_[static_cast<std::size_t>(dimension_ - 1)]); }

    /// Rows that keep the last displacement of the bottom nodes above a bound.
    SparseMatrix bottom_rows() const {
        const std::vector<Index> nodes = bottom();
        std::vector<Eigen::Triplet<double, long>> entries;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            entries.emplace_back(static_cast<long>(i), unknown(nodes[i], dimension_ - 1), 1.0);
        SparseMatrix B(static_cast<Index>(nodes.size()), size());
        B.setFromTriplets(entries.begin(), entries.end());
        return B;
    }

    /// Translations, then rotations about the origin: 3 in 2-D, 6 in 3-D.
    DenseMatrix rigid_modes() const {
        DenseMatrix R = DenseMatrix::Zero(size(), dimension_ == 2 ? 3 : 6);
        for (Index i = 0; i < nodes(); ++i) {
            const auto X = place(i);
            for (int d = 0; d < dimension_; ++d) R(unknown(i, d), d) = 1;
            int column = dimension_;
            for (int a = 0; a < dimension_; ++a)
                for (int b = a + 1; b < dimension_; ++b, ++column) {
                    R(unknown(i, a), column) = -X[static_cast<std::size_t>(b)];
                    R(unknown(i, b), column) = X[static_cast<std::size_t>(a)];
                }
        }
        return R;
    }

private:
    Index along(std::size_t d) const { return cells_[d] + 1; }

    std::vector<Index> face(int level) const {
        std::vector<Index> nodes;
        for (int y = 0; y < (dimension_ == 3 ? along(1) : 1); ++y)
            for (int x = 0; x < along(0); ++x) nodes.push_back(dimension_ == 3 ? node(x, y, level) : node(x, level));
        return nodes;
    }

    /// Stiffness and mass of one cell, by two Gauss points a direction; corners numbered along x first.
    void cell(DenseMatrix& Ke, DenseMatrix& Me) const {
        const int d = dimension_, corners = 1 << d;
        const double nu = 0.3, mu = 0.5 / (1 + nu), lambda = nu / ((1 + nu) * (1 - 2 * nu)), g = 0.5 / std::sqrt(3.0);
        Ke = Me = DenseMatrix::Zero(d * corners, d * corners);
        const double weight = std::pow(h_, d) / corners;
        for (int point = 0; point < corners; ++point) {
            DenseMatrix gradient(corners, d);
            Vector shape(corners);
            for (int a = 0; a < corners; ++a) {
                double value = 1;
                for (int k = 0; k < d; ++k) {
                    const double x = 0.5 + (point >> k & 1 ? g : -g);
                    value *= a >> k & 1 ? x : 1 - x;
                }
                shape[a] = value;
                for (int k = 0; k < d; ++k) {
                    double slope = (a >> k & 1 ? 1 : -1) / h_;
                    for (int l = 0; l < d; ++l) {
                        const double x = 0.5 + (point >> l & 1 ? g : -g);
                        if (l != k) slope *= a >> l & 1 ? x : 1 - x;
                    }
                    gradient(a, k) = slope;
                }
            }
            for (int a = 0; a < corners; ++a)
                for (int b = 0; b < corners; ++b)
                    for (int i = 0; i < d; ++i) {
                        Me(d * a + i, d * b + i) += weight * shape[a] * shape[b];
                        for (int j = 0; j < d; ++j) {
                            double k =
                                lambda * gradient(a, i) * gradient(b, j) + mu * gradient(a, j) * gradient(b, i);
                            if (i == j) k += mu * gradient.row(a).dot(gradient.row(b));
                            Ke(d * a + i, d * b + j) += weight * k;
                        }
                    }
        }
    }

    void assemble() {
        const int d = dimension_, corners = 1 << d;
        DenseMatrix Ke, Me;
        cell(Ke, Me);
        Ke = (0.5 * (Ke + Ke.transpose())).eval();
        std::vector<Eigen::Triplet<double, long>> k, m;
        for (int z = 0; z < std::max(cells_[2], 1); ++z)
            for (int y = 0; y < cells_[1]; ++y)
                for (int x = 0; x < cells_[0]; ++x)
                    for (int a = 0; a < corners; ++a)
                        for (int b = 0; b < corners; ++b) {
                            const Index p = node(x + (a & 1), y + (a >> 1 & 1), z + (a >> 2 & 1));
                            const Index q = node(x + (b & 1), y + (b >> 1 & 1), z + (b >> 2 & 1));
                            for (int i = 0; i < d; ++i)
                                for (int j = 0; j < d; ++j) {
                                    k.emplace_back(d * p + i, d * q + j, Ke(d * a + i, d * b + j));
                                    if (i == j) m.emplace_back(d * p + i, d * q + j, Me(d * a + i, d * b + j));
                                }
                        }
        K_.resize(size(), size());
        M_.resize(size(), size());
        K_.setFromTriplets(k.begin(), k.end());
        M_.setFromTriplets(m.begin(), m.end());
        K_ = 0.5 * (K_ + SparseMatrix(K_.transpose()));
    }

    int dimension_;
    std::array<int, 3> cells_;
    double h_;
    SparseMatrix K_, M_;
};

}  // namespace tact::test
