// The American put: a parabolic obstacle problem, first order in time and not symmetric.
#pragma once

#include "mesh.hpp"

namespace tact {

/// Prices in the strike's currency, times in years.
struct AmericanPutData {
    double strike = 100;
    double rate = 0.05;       ///< of interest, continuous
    double volatility = 0.2;  ///< per square root of a year
    double highest = 300;     ///< price at which the put is taken as worthless
};

/// u(S, t), the value of a put with the time t left, is never below its payoff max(strike - S, 0) and starts from it:
///   u_t = volatility^2/2 S^2 u_SS + rate S u_S - rate u + lambda,   lambda >= 0 where it is exercised.
/// There is no M; D is the identity and K, by central differences on `cells` cells of 0 < S < highest, is not symmetric. At
/// S = 0 the equation needs no boundary value. Where convection outweighs diffusion (S < rate/volatility^2 cells) it is
/// differenced upwind, so that K always has the signs of an M-matrix. Second order in the cell, best with the strike at a node.
/// InputError for bad data or fewer than 2 cells. (Black, Scholes; Wilmott, Howison, Dewynne, 1995, section 7.)
Scene american_put(Index cells, const AmericanPutData& data = {});

/// The highest price of the mesh at which lambda says exercise; 0 if none.
double exercise_price(const Mesh& mesh, const ConstVectorRef& lambda);

}  // namespace tact
