// Elastic bars that meet a wall or each other, with what happens exactly.
#pragma once

#include "line_elements.hpp"
#include "mesh.hpp"

namespace tact {

/// What holds at one point of a continuous body at one time. Where v or the stress jumps, before the jump.
struct BarState {
    double u = 0;       ///< displacement
    double v = 0;       ///< velocity
    double stress = 0;  ///< E u_x, positive in tension
};

/// Any consistent units. Section 1.
struct BarImpactData {
    double length = 10;     ///< L
    double density = 1;     ///< rho, mass per length
    double modulus = 900;   ///< E
    double velocity = -10;  ///< v0 at first, towards the wall where negative
    double gap = 5;         ///< h0, between the wall and the bar's end at first
    double gravity = 0;     ///< g, towards the wall
};

/// rho u_tt = E u_xx - rho g on (0, L), both ends free; u(0, t) >= 0 is the wall; u = h0 and u_t = v0 at first. Linear
/// elements; K is singular, for the bar is free to move. One contact row, at node 0; lambda is the contact force.
/// InputError for bad data or no elements.
Scene bar_impact(Index elements, const BarImpactData& data = {}, Mass mass = Mass::lumped);

/// The exact motion without gravity, 0 <= x <= L, t >= 0. The bar touches at t1 = h0/|v0|, stays for 2 L/c with
/// c = sqrt(E/rho), and leaves rigidly with -v0: with s = t - t1, u = |v0| max(-s, -x/c, s - 2L/c).
/// InputError unless v0 < 0 and g = 0.
BarState bar_impact_exact(const BarImpactData& data, double x, double t);
/// The contact force: |v0| sqrt(E rho) from t1 to t1 + 2 L/c, else zero; its impulse is 2 rho L |v0|.
double bar_impact_force(const BarImpactData& data, double t);

/// u_tt = u_xx on (0, 1), u(1, t) = 0, u(0, t) >= 0, u = (1 - x)/2 and u_t = 0 at first: a bar that bounces for ever with
/// period 3 and energy 1/8. `elements` unknowns. InputError if there are none.
/// (Dabaghi, Petrov, Pousin, Renard, ESAIM: M2AN 48, 2014; an example of GetFEM.)
Scene bouncing_bar(Index elements, Mass mass = Mass::lumped);
/// With s = t modulo 3, by d'Alembert: u = min(1 - s, 1 - x)/2 up to s = 1, where the whole bar has u = 0, v = -1/2;
/// u = -min(s - 1, 2 - s, x, 1 - x)/2 in contact up to s = 2; then min(s - 2, 1 - x)/2.
BarState bouncing_bar_exact(double x, double t);
/// The contact force: 1/2 for 1 < s < 2.
double bouncing_bar_force(double t);

/// One of two bars on one line. Any consistent units. Section 1.
struct Bar {
    double length = 10;
    double density = 1;
    double modulus = 900;
    double velocity = 0;  ///< at first, positive to the right
    Index elements = 100;
};
struct TwoBarsData {
    Bar left{.velocity = 10};
    Bar right{};
    double gap = 5;  ///< between them at first
};

/// Two free bars, one behind the other; the left one's nodes come first. In the coordinate along each bar at rest and in
/// touch, the left one is (-L1, 0), the right one (0, L2), and u_right(0) - u_left(0) + gap >= 0.
/// InputError for bad data or no elements.
Scene two_bars(const TwoBarsData& data = {}, Mass mass = Mass::lumped);

/// Exact for bars of equal travel time L/c: the contact force v Z1 Z2/(Z1 + Z2), v = v1 - v2, Z = sqrt(E rho), from gap/v for
/// 2 L/c, after which both move rigidly as two elastic balls of their masses would: equal bars swap their velocities.
/// `x` from -L1 to L2; at x = 0 the bar is the left one if `body` is 0, else the right one.
/// InputError unless v1 > v2 and the travel times agree to 1e-12.
BarState two_bars_exact(const TwoBarsData& data, double x, double t, std::size_t body);
double two_bars_force(const TwoBarsData& data, double t);

}  // namespace tact
