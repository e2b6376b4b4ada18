// Takes the inertia away from where contact is, so that an impact has no node of its own to bounce.
#pragma once

#include "tact/lib/contact_problem.hpp"

namespace tact {

/// The same problem with the mass of the unknowns that B touches moved to their neighbours in K that it does not touch, save
/// the fraction `keep`, which leaves M invertible. A contact unknown then follows the rest of the body quasi-statically: no
/// restitution at the node, contact forces without oscillation, no energy lost or gained at an impact.
///
/// The shares are proportional to the coupling -K_ij > 0 (to |K_ij| where there is none such), so the total mass stays to
/// rounding, and so does the centre of mass where row i of K lets a rigid motion and a uniform strain be and all of its
/// neighbours are free of contact: inside a line or a surface of equal elements, not at the end of a bar, where it moves
/// by a fraction of an element. An unknown among contact unknowns only passes its mass on through those nearer to the free ones.
/// For lumped M and one unknown a node: components of a vector field would have to receive their own direction's mass only.
/// M alone changes; a D that was built from M stays. InputError unless M is there and diagonal, keep is in [0, 1], and every
/// contact unknown reaches a free one through K.
/// (Khenous, Laborde, Renard, Eur. J. Mech. A 27, 2008.)
ContactProblem redistribute_mass(const ContactProblem& problem, double keep = 1e-14);

}  // namespace tact
