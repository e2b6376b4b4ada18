#include "neighbour.hpp"

#include <Eigen/Dense>

// Another library that uses Eigen and has never heard of tact.
Eigen::VectorXd weights(int n) { return Eigen::VectorXd::Constant(n, 1.0 / n); }

Eigen::MatrixXd inverse_of(Eigen::MatrixXd A) {
    A.conservativeResize(A.rows(), A.cols());
    return A.lu().inverse();
}
