// Takes the inertia away from where contact is, so that an impact has no node of its own to bounce.
#pragma once

#include "contact_problem.hpp"

namespace tact {

/// The same problem with the mass of the unknowns that B touches moved to their neighbours in K that it does not touch, save
/// the fraction `keep`, which leaves M invertible. A contact unknown without mass follows the rest of the body in
/// equilibrium: in continuous time its contact force is continuous, it needs no impact law and the energy is kept.
///
/// Shares go by the coupling -K_ij > 0 in K's symmetric part (by |K_ij| where there is none such). The total mass stays to
/// rounding. So does the centre of mass where the row of K lets rigid motions and uniform strains be and all neighbours are
/// free of contact: inside a line or a surface of equal elements; at the end of a bar it moves by a fraction of an element.
/// An unknown among contact unknowns passes its mass on through those nearer to the free ones. One unknown a node: the
/// components of a vector field would have to receive mass of their own direction only.
///
/// With hardly any mass left (`keep` < 1e-6) contact unknowns start in equilibrium with the others: u0 by K and the load at
/// t = 0 as far as the rows allow, v0 by K alone; at rest out of equilibrium they would oscillate faster than any step follows.
/// D, also one that was built from M, stays. InputError unless the problem is valid, M is there and diagonal, keep is
/// in [0, 1], and every contact unknown reaches a free one through K.
/// (Khenous, Laborde, Renard, Eur. J. Mech. A 27, 2008.)
ContactProblem redistribute_mass(const ContactProblem& problem, double keep = 1e-14);

}  // namespace tact
