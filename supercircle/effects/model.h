#pragma once
// The combined effects of one world, slot by slot: plain numbers that the step, the laboratory and the replay read. All
// defaults are off.

#include "supercircle/effects/laws/spline.h"
#include "supercircle/rod/arc.h"

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace supercircle::effects {

using rod::Vec2;

/// Every effect of the catalogue, in its order; energies are recorded by it.
enum class Key : std::uint8_t {
    ViscoelasticBending,
    NonlinearElasticity,
    Plasticity,
    LocalDamage,
    NaturalCurvatureDefect,
    StiffnessGradient,
    SofteningOverTime,
    PlanarDrag,
    Gravity,
    StaticFrictionExcess,
    RateDependentFriction,
    Wear,
    Adhesion,
    ContactCompliance,
    MachineCompliance,
    Backlash,
    Misalignment,
    SensorDrift,
    SensorGain,
    SensorDelay,
    BearingFriction,
    AirDrag,
    GuideFriction,
    NonlinearSpring,
    RateAndStateFriction,
    SupportSettlement,
    ClampCompliance,
    Count
};
inline constexpr std::size_t kKeys = static_cast<std::size_t>(Key::Count);

/// Energy that an effect has taken.
struct EffectEnergy {
    double stored = 0.0;     ///< stored now, J (negative: less than without the effect)
    double dissipated = 0.0; ///< dissipated so far, J, never decreases
};
using EffectEnergies = std::array<EffectEnergy, kKeys>;
/// All that effects have taken: stored and dissipated, J.
[[nodiscard]] inline double taken(const EffectEnergies& energies) {
    double sum = 0.0;
    for (const EffectEnergy& e : energies)
        sum += e.stored + e.dissipated;
    return sum;
}

/// A change of the section along the rod.
struct Profile {
    enum class Shape : std::uint8_t {
        Gauss,    ///< exp(-((s - s0) / width)^2 / 2)
        Flat,     ///< 1 on a part of length `width` around s0, 0 elsewhere
        Linear,   ///< 2 s / L - 1: from -1 at the first end to 1 at the last
        Thickness ///< stiffness (1 + amount * (2 s / L - 1))^3
    };
    Key cause = Key::LocalDamage;
    Shape shape = Shape::Gauss;
    double centre = 0.5;    ///< arc fraction s0 / L, 1
    double width = 1.0;     ///< m
    double stiffness = 0.0; ///< B is multiplied by 1 + stiffness * shape, 1
    double curvature = 0.0; ///< natural curvature is increased by curvature * shape, 1/m
    bool operator==(const Profile&) const = default;
};

/// Elastic moment over curvature change, per bending modulus.
struct ElasticModel {
    enum class Law : std::uint8_t { Linear, Softening, Stiffening, RambergOsgood, Learned, Table };
    Law law = Law::Linear;
    double knee = std::numeric_limits<double>::infinity(); ///< u_c; for a learned law the end of its range, 1/m
    double exponent = 3.0;                                 ///< n of Ramberg-Osgood, 1
    SplineCoefficients learned{};                          ///< tangent modulus / B - 1 against |u| / u_c, 1
    TableCoefficients table{};                             ///< the same of a table, 1
    bool operator==(const ElasticModel&) const = default;
};

/// A Maxwell element beside the bending spring.
struct MaxwellBranch {
    double stiffness = 0.0; ///< fraction of B, 1
    double time = 1.0;      ///< relaxation time, s
    bool operator==(const MaxwellBranch&) const = default;
};

/// Moment-curvature law of a rod that differs from B (kappa - kappa0).
struct MaterialModel {
    std::vector<Profile> profiles;
    ElasticModel elastic;
    double viscosity = 0.0; ///< eta / B, s
    std::vector<MaxwellBranch> branches;
    double yield = std::numeric_limits<double>::infinity(); ///< M_y / B, 1/m
    double hardening = 0.0;                                 ///< H / B, 1
    bool kinematic = false;                                 ///< kinematic instead of isotropic hardening
    double softening = 0.0;                                 ///< fraction of B that is lost in the end, or per decade, 1
    double softeningTime = 1.0;                             ///< s
    bool softeningByDecades = false;                        ///< logarithmic in time

    [[nodiscard]] bool on() const;
    bool operator==(const MaterialModel&) const = default;
};

/// Dry friction of every point of the rod against walls in front and behind.
struct DragModel {
    double force = 0.0;       ///< per length, N/m
    double presliding = 3e-6; ///< m, elastic motion before it slides

    [[nodiscard]] bool on() const { return force > 0.0; }
    bool operator==(const DragModel&) const = default;
};

/// Air that resists the motion of every point of a rod along its normal. Friction along the tangent and the mass of air
/// that moves with the rod are left out.
struct AirModel {
    double linear = 0.0;    ///< force per length over speed, N s/m^2
    double quadratic = 0.0; ///< force per length over speed squared, N s^2/m^3

    [[nodiscard]] bool on() const { return linear > 0.0 || quadratic > 0.0; }
    bool operator==(const AirModel&) const = default;
};

/// How the friction coefficient of a contact depends on its state, as factors of the declared one.
struct FrictionModel {
    enum class Rate : std::uint8_t { Stribeck, Logarithmic, Viscous, Learned, Table };
    enum class Wear : std::uint8_t { Exponential, Learned, Table };
    double staticRatio = 1.0;    ///< mu_s / mu_k, 1
    double slipWeakening = 1e-4; ///< D_c, m
    double healing = 1.0;        ///< time constant at rest after which the excess has recovered, s
    double presliding = 0.0;     ///< elastic motion of a contact before it slides, m; 0: none
    Rate rate = Rate::Stribeck;
    double rateStrength = 0.0; ///< relative change, 1
    double rateSpeed = 1e-3;   ///< m/s; of a learned law the middle of its four decades, of a table of six
    double wearChange = 0.0;   ///< relative change in the end, 1
    double wearDistance = 0.1; ///< m; of a learned law or a table the end of its range
    Wear wear = Wear::Exponential;
    SplineCoefficients rateCurve{}, wearCurve{}; ///< of learned laws, 1
    TableCoefficients rateTable{}, wearTable{};  ///< of tables, 1
    double direct = 0.0;                         ///< of rate and state: a over the declared coefficient, 1
    double evolution = 0.0;                      ///< b over the declared coefficient, 1
    double stateSlip = 1e-5;                     ///< D_c, m
    double stateSpeed = 1e-3;                    ///< V0, of steady sliding with the declared coefficient, m/s
    double stateCreep = 1e-7;                    ///< speed below which friction does not depend on it, m/s
    double stateRest = 60.0;                     ///< age of the contacts of a rested surface, s
    bool stateBySlip = false;                    ///< slip law instead of ageing law

    [[nodiscard]] bool rateAndState() const { return direct != 0.0 || evolution != 0.0; }
    [[nodiscard]] bool on() const {
        return staticRatio != 1.0 || rateStrength != 0.0 || wearChange != 0.0 || rateAndState();
    }
    bool operator==(const FrictionModel&) const = default;
    [[nodiscard]] bool compliant() const { return staticRatio != 1.0 && presliding > 0.0; }
};

/// Attraction of near surfaces: force per length of rod against the gap.
struct AdhesionModel {
    enum class Law : std::uint8_t { Hump, Decaying, Learned };
    Law law = Law::Hump;
    double force = 0.0;           ///< largest, N/m
    double range = 1e-4;          ///< gap at which it vanishes, m
    double spotSpacing = 0.0;     ///< distance of attracting spots along the rod, including both tips, m; 0: everywhere
    SplineCoefficients learned{}; ///< attraction / force against gap / range, 1

    [[nodiscard]] bool on() const { return force > 0.0; }
    bool operator==(const AdhesionModel&) const = default;
};

/// Compliance of every contact.
struct ContactComplianceModel {
    double normal = 0.0;     ///< m/N
    double tangential = 0.0; ///< m/N

    [[nodiscard]] bool on() const { return normal > 0.0 || tangential > 0.0; }
    bool operator==(const ContactComplianceModel&) const = default;
};

struct ContactModel {
    FrictionModel friction;
    AdhesionModel adhesion;
    ContactComplianceModel compliance;

    [[nodiscard]] bool on() const { return friction.on() || adhesion.on() || compliance.on(); }
    bool operator==(const ContactModel&) const = default;
    /// True if contacts have springs of their own.
    [[nodiscard]] bool compliant() const { return compliance.on() || friction.compliant(); }
};

/// The testing machine.
struct ApparatusModel {
    double compliance = 0.0;      ///< of the machine, m/N
    double backlash = 0.0;        ///< travel lost at a reversal, m
    double slack = 0.0;           ///< travel lost where the force changes its sign, m
    double slackForce = 1e-3;     ///< force scale over which the slack is taken up, N
    double bedding = 0.0;         ///< travel lost for good, over the largest force so far, m/N
    double offset = 0.0;          ///< sideways position of what the crosshead carries, m
    double tilt = 0.0;            ///< its rotation, rad
    double clampCompliance = 0.0; ///< angle over moment of every clamp, rad/(N m)

    /// Whether the crosshead is not where it is commanded.
    [[nodiscard]] bool on() const {
        return compliance > 0.0 || backlash > 0.0 || slack > 0.0 || bedding > 0.0 || offset != 0.0 || tilt != 0.0;
    }
};

/// Of every clamp, torque over angle, N m; 0: rigid.
[[nodiscard]] inline double turnStiffness(const ApparatusModel& a) {
    return a.clampCompliance > 0.0 ? 1.0 / a.clampCompliance : 0.0;
}

/// The load cell and its signal chain.
struct SensorModel {
    double drift = 0.0;     ///< final drift, N
    double driftTime = 1.0; ///< time constant of the drift, s
    double driftRate = 0.0; ///< steady drift, N/s
    double gain = 0.0;      ///< reading = (1 + gain) force, 1
    double delay = 0.0;     ///< s
    double lag = 0.0;       ///< time constant of a first-order low pass, s

    [[nodiscard]] bool on() const {
        return drift != 0.0 || driftRate != 0.0 || gain != 0.0 || delay > 0.0 || lag > 0.0;
    }
};

/// Joints of rigid bodies and the air around them (entries/air_drag.cpp, entries/bearing_friction.cpp, ...).
struct BodiesModel {
    double bearingTorque = 0.0;      ///< dry, N m
    double bearingArm = 0.0;         ///< dry torque over reaction, m
    double bearingViscosity = 0.0;   ///< torque over spin, N m s
    double airLinear = 0.0;          ///< force per length over speed, N s/m^2
    double airQuadratic = 0.0;       ///< force per length over speed squared, N s^2/m^3
    double guideForce = 0.0;         ///< dry, N
    double guideViscosity = 0.0;     ///< force over speed, N s/m
    double guideQuadratic = 0.0;     ///< force over speed squared, N s^2/m^2
    double springCubic = 0.0;        ///< added to that of springs, 1/m^2
    double turningSpringCubic = 0.0; ///< the same of turning springs, 1/rad^2

    [[nodiscard]] bool on() const {
        return bearingTorque > 0.0 || bearingArm > 0.0 || bearingViscosity > 0.0 || airLinear > 0.0 ||
               airQuadratic > 0.0 || guideForce > 0.0 || guideViscosity > 0.0 || guideQuadratic > 0.0 ||
               springCubic != 0.0 || turningSpringCubic != 0.0;
    }
};

struct Model {
    MaterialModel material;
    DragModel drag;
    AirModel air;
    Vec2 gravity = Vec2::Zero(); ///< added to the declared gravity, m/s^2
    ContactModel contact;
    ApparatusModel apparatus;
    SensorModel sensor;
    BodiesModel bodies;
};

} // namespace supercircle::effects
