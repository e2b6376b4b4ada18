#pragma once

#include <Eigen/Core>

Eigen::VectorXd weights(int n);
Eigen::MatrixXd inverse_of(Eigen::MatrixXd A);
