#pragma once
// The constant description of one Super-Circle rod: dimensions, material, and how its coordinates are laid out.
//
// Layout of q and v (n = N + 3 entries), chosen for the block-arrow shape of the mass matrix: a point right of the
// middle does not feel the curvatures left of it and vice versa, so with
//     [ curvatures left of the middle | right of it | of the middle element (odd N) | x, y, theta ]
// the Cholesky factor has no fill between the two halves and a contact row touches 11 of 18 entries (N = 15).

#include "supercircle/rod/arc.h"

#include <string>
#include <vector>

namespace supercircle::rod {

/// What a rod is made of; SI units.
struct RodDefinition {
    double length = 0.09;                 ///< arc length L, m
    double thickness = 5e-4;              ///< h, m
    double linearMass = 6.35e-3;          ///< lambda = rho w h, kg/m
    double bendingModulus = 2.2917e-4;    ///< B = E w h^3 / 12, N m^2
    std::vector<double> naturalCurvature; ///< per element, 1/m; its size is the number of elements N
    bool closed = false;                  ///< ends welded into a ring
};

/// Empty if the definition can be simulated, else what is wrong with it.
std::string validate(const RodDefinition& definition);

/// A stretch of one element between the frame at mid-length and a tip, in outward order.
struct Segment {
    int element = 0;
    int dof = 0;               ///< index of its curvature in q
    double innerS = 0.0;       ///< rod arc length of its inner end, m
    double signedLength = 0.0; ///< m, negative left of the middle
};

class RodModel {
public:
    /// Gauss points per segment: exact to round-off for arcs of up to about half a radian.
    static constexpr int kGauss = 5;
    /// Nodes (fraction of the segment from its inner end) and weights of the rule.
    static constexpr double kGaussNode[kGauss] = {0.046910077030668004, 0.230765344947158454, 0.5, 0.769234655052841546,
                                                  0.953089922969331996};
    static constexpr double kGaussWeight[kGauss] = {0.118463442528094544, 0.239314335249683234, 0.284444444444444444,
                                                    0.239314335249683234, 0.118463442528094544};

    explicit RodModel(RodDefinition definition);

    [[nodiscard]] int elements() const { return elements_; }
    [[nodiscard]] int dofs() const { return elements_ + 3; }
    [[nodiscard]] int dofOfElement(int element) const;
    [[nodiscard]] int dofX() const { return elements_; }
    [[nodiscard]] int dofY() const { return elements_ + 1; }
    [[nodiscard]] int dofTheta() const { return elements_ + 2; }
    [[nodiscard]] double elementLength() const { return elementLength_; }
    [[nodiscard]] double midS() const { return 0.5 * definition_.length; }
    [[nodiscard]] const RodDefinition& definition() const { return definition_; }
    [[nodiscard]] double mass() const { return definition_.linearMass * definition_.length; }
    /// side 0: towards the last tip (s > mid), side 1: towards the first tip.
    [[nodiscard]] const std::vector<Segment>& side(int which) const { return sides_[which]; }
    [[nodiscard]] int gaussPoints() const { return kGauss * static_cast<int>(sides_[0].size() + sides_[1].size()); }

private:
    RodDefinition definition_;
    int elements_ = 0;
    double elementLength_ = 0.0;
    std::vector<Segment> sides_[2];
};

} // namespace supercircle::rod
