#pragma once
// The energy balance: energy recorded per cause, and the residual that should vanish.
//
//   (kinetic + bending + gravity) - added = work - friction - impact - numerical - positionCorrection - effects -
//   damping - toBodies + residual
//
// Each term comes from the implicit step itself; nothing is inferred from the residual. Equations of the terms:
// docs/theory/time_step.md. Impact is physics (Moreau's law, restitution 0). Numerical dissipation and push-out are
// artefacts and must stay small beside friction.

#include <algorithm>

namespace supercircle::step {

/// Energy that closing gaps brought in, J, each >= 0 and growing. It is part of positionCorrection, which is net.
struct InjectedEnergy {
    double contact = 0.0; ///< overlaps pushed out
    double link = 0.0;    ///< joints closed
    double hold = 0.0;    ///< held points and ends of rings brought to their places
    double drift = 0.0;   ///< copies of bodies brought to their originals
    double rolling = 0.0; ///< forces whose rows turn within a step, contacts' points roll (contact_stiffness.h)

    [[nodiscard]] double sum() const { return contact + link + hold + drift + rolling; }
    InjectedEnergy& operator+=(const InjectedEnergy& o) {
        contact += o.contact;
        link += o.link;
        hold += o.hold;
        drift += o.drift;
        rolling += o.rolling;
        return *this;
    }
};

struct EnergyBalance {
    double kinetic = 0.0;   ///< now, J
    double bending = 0.0;   ///< now, J
    double gravity = 0.0;   ///< now, J (potential -m g . x of the shells)
    double added = 0.0;     ///< energy of shells when they were put in (minus taken out, minus changes of gravity), J
    double work = 0.0;      ///< done on the shells by machine, holds and moving bodies, J
    double friction = 0.0;  ///< dissipated, J
    double impact = 0.0;    ///< dissipated in plastic impacts, J
    double numerical = 0.0; ///< dissipated by the time integration, J
    double positionCorrection = 0.0; ///< lost by moving along normals less what closing gaps injected, J
    InjectedEnergy injected;         ///< that part of it, by cause
    double effects = 0.0;            ///< dissipated or stored by effects, J
    double damping = 0.0;            ///< dissipated by the shells' own damping, J
    double toBodies = 0.0;           ///< given to dynamic host bodies, J

    /// Books what a body's way to its original did; it is nobody's work.
    void addDrift(double energy) {
        positionCorrection -= energy;
        injected.drift += std::max(0.0, energy);
    }
    /// Takes in the balance of a part of the world, or of a later time.
    EnergyBalance& operator+=(const EnergyBalance& o) {
        kinetic += o.kinetic;
        bending += o.bending;
        gravity += o.gravity;
        added += o.added;
        work += o.work;
        friction += o.friction;
        impact += o.impact;
        numerical += o.numerical;
        positionCorrection += o.positionCorrection;
        injected += o.injected;
        effects += o.effects;
        damping += o.damping;
        toBodies += o.toBodies;
        return *this;
    }
    /// Lost by moving along normals, J.
    [[nodiscard]] double lostToCorrection() const { return positionCorrection + injected.sum(); }
    [[nodiscard]] double stored() const { return kinetic + bending + gravity; }
    /// What does not close, J.
    [[nodiscard]] double residual() const {
        return stored() - added -
               (work - friction - impact - numerical - positionCorrection - effects - damping - toBodies);
    }
};

static_assert(sizeof(EnergyBalance) == 17 * sizeof(double), "a new term is added up, too (operator+=)");

} // namespace supercircle::step
