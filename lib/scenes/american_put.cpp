#include "american_put.hpp"

#include <vector>

#include "line_elements.hpp"

namespace tact {

Scene american_put(Index cells, const AmericanPutData& data) {
    const char* object = "AmericanPutData";
    check_elements("american_put", cells, 2);
    check_data(object, "strike", data.strike, data.strike > 0, "a positive number");
    check_data(object, "rate", data.rate, data.rate >= 0, "zero or more");
    check_data(object, "volatility", data.volatility, data.volatility > 0, "a positive number");
    check_data(object, "highest", data.highest, data.highest > data.strike, "more than the strike");
    Scene scene;
    scene.mesh.add_line(0, data.highest, cells, Mesh::Ends::right_fixed);
    std::vector<Eigen::Triplet<double, long>> entries;
    for (Index i = 0; i < cells; ++i) {
        // S = i h: neither coefficient depends on the cell.
        const double s = static_cast<double>(i);
        const double diffusion = data.volatility * data.volatility * s * s / 2, convection = data.rate * s;
        const bool central = 2 * diffusion >= convection;
        const double below = central ? diffusion - convection / 2 : diffusion;
        const double above = central ? diffusion + convection / 2 : diffusion + convection;
        entries.emplace_back(i, i, below + above + data.rate);
        if (i > 0) entries.emplace_back(i, i - 1, -below);
        if (i + 1 < cells) entries.emplace_back(i, i + 1, -above);
    }
    SparseMatrix K(cells, cells);
    K.setFromTriplets(entries.begin(), entries.end());
    ContactProblem& problem = scene.problem;
    problem.D = Matrix::identity(cells);
    problem.K = Matrix(std::move(K));
    problem.B = Matrix::identity(cells);
    problem.u0 = (data.strike - scene.mesh.bodies[0].line.array()).max(0);
    problem.c = Vector(problem.u0);
    problem.f = Vector(Vector::Zero(cells));
    return scene;
}

double exercise_price(const Mesh& mesh, const ConstVectorRef& lambda) {
    for (Index i = lambda.size() - 1; i >= 0; --i)
        if (lambda[i] > 0) return mesh.bodies[0].line[i];
    return 0;
}

}  // namespace tact
