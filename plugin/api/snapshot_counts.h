#pragma once
// The saved fields of energies and counters (for plugin/api and the checkpoints of plugin/lab); see snapshot_fields.h.

#include "plugin/api/snapshot_archive.h"
#include "supercircle/step/world.h"

namespace supercircle::archive {

/// A value that does not count in the hash while it changes nothing.
template <class Ar>
void ioUnless(Ar& ar, bool neutral, auto& value) {
    if (neutral)
        ar.unhashed(value);
    else
        ar(value);
}

template <class Ar>
void io(Ar& ar, Is<step::EnergyBalance> auto& l) {
    auto& [kinetic, bending, gravity, added, work, friction, impact, numerical, positionCorrection, injected, effects,
           damping, toBodies] = l;
    auto& [contact, link, hold, drift, rolling] = injected;
    ar(kinetic, bending, gravity, added, work, friction, impact, numerical, positionCorrection, effects, toBodies);
    ioUnless(ar, !(damping > 0.0), damping);
    ar.unhashed(contact, link, hold, drift, rolling); // parts of positionCorrection
}

template <class Ar>
void io(Ar& ar, Is<step::Counters> auto& c) {
    auto& [steps, rejected, rejectedFor, solves, gaussSeidelIterations, pivots, unconverged, byAbsoluteFloor, crossings,
           quarantined, contactResidualMax, contactsMax, activeContactsMax, penetrationMax] = c;
    ar(steps, rejected);
    const auto late = static_cast<std::size_t>(step::Reason::StatusChange);
    for (std::size_t i = 0; i < late; ++i)
        ar(rejectedFor[i]);
    for (std::size_t i = late; i < rejectedFor.size(); ++i)
        ioUnless(ar, rejectedFor[i] == 0, rejectedFor[i]); // quasi-static runs have none
    ar(solves, gaussSeidelIterations, pivots, unconverged, byAbsoluteFloor, crossings, quarantined, contactResidualMax,
       contactsMax, activeContactsMax, penetrationMax);
}

} // namespace supercircle::archive
