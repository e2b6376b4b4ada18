#include "line_elements.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "../errors.hpp"

namespace tact {
namespace {

/// Every element (diagonal, off_diagonal; off_diagonal, diagonal).
SparseMatrix assemble(Index elements, double diagonal, double off_diagonal) {
    std::vector<Eigen::Triplet<double, long>> entries;
    entries.reserve(static_cast<std::size_t>(4 * elements));
    for (Index e = 0; e < elements; ++e) {
        entries.emplace_back(e, e, diagonal);
        entries.emplace_back(e + 1, e + 1, diagonal);
        if (off_diagonal == 0) continue;
        entries.emplace_back(e, e + 1, off_diagonal);
        entries.emplace_back(e + 1, e, off_diagonal);
    }
    SparseMatrix A(elements + 1, elements + 1);
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
}

}  // namespace

SparseMatrix line_stiffness(Index elements, double length, double modulus) {
    const double k = modulus * static_cast<double>(elements) / length;
    return assemble(elements, k, -k);
}

SparseMatrix line_mass(Index elements, double length, double density, Mass mass) {
    const double m = density * length / static_cast<double>(elements);
    return mass == Mass::lumped ? assemble(elements, m / 2, 0) : assemble(elements, m / 3, m / 6);
}

Matrix mass_matrix(SparseMatrix entries, Mass mass) {
    return mass == Mass::lumped ? Matrix::diagonal(entries.diagonal()) : Matrix(std::move(entries));
}

SparseMatrix single_row(Index columns, std::initializer_list<std::pair<Index, double>> entries) {
    SparseMatrix row(1, columns);
    for (const auto& [column, value] : entries) row.insert(0, column) = value;
    row.makeCompressed();
    return row;
}

void check_data(const char* object, const char* field, double value, bool ok, const char* expected) {
    if (!std::isfinite(value) || !ok)
        throw InputError(std::string(object) + ": " + field + " is " + shown(value) + ", expected " + expected);
}

void check_elements(const char* object, Index elements, Index at_least) {
    if (elements < at_least)
        throw InputError(std::string(object) + ": elements is " + std::to_string(elements) + ", expected at least " +
                         std::to_string(at_least));
}

}  // namespace tact
