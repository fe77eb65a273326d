#pragma once
// The constant description of one rod: dimensions, material, and the layout of its coordinates.
//
// Layout of q and v (n = N + 3 entries):
//     [ curvatures left of the middle | right of it | of the middle element (odd N) | x, y, theta ]
// A point right of the middle does not depend on the curvatures left of it, and vice versa. With this order the
// Cholesky factor of the mass matrix has no fill between the two halves. A contact row has 11 non-zeros of 18 (N = 15).
//
// Elements have equal lengths unless given otherwise; shorter elements at the tips do not pay (decision 0120).

#include "supercircle/rod/arc.h"

#include <string>
#include <utility>
#include <vector>

namespace supercircle::rod {

/// A small heavy body on the rod, such as an accelerometer: it moves with its section and does not stiffen the rod.
struct PointMass {
    double s = 0.0;       ///< arc length of its place, m
    double mass = 0.0;    ///< kg
    double inertia = 0.0; ///< about its place, kg m^2
    bool operator==(const PointMass&) const = default;
};

/// What a rod is made of; SI units.
struct RodDefinition {
    double length = 0.09;                 ///< arc length L, m
    double thickness = 5e-4;              ///< h, m
    double linearMass = 6.35e-3;          ///< lambda = rho w h, kg/m
    double bendingModulus = 2.2917e-4;    ///< B = E w h^3 / 12, N m^2
    std::vector<double> naturalCurvature; ///< per element, 1/m; its size is the number of elements N
    bool closed = false;                  ///< both ends welded together: a ring
    /// Per element, m, mirrored about the middle, with the sum `length`; empty: all equal.
    std::vector<double> elementLength;
    std::vector<PointMass> pointMasses;
};

/// Of the rod and what it carries, kg.
double massOf(const RodDefinition& definition);

/// Element lengths (m) in geometric progression from the middle to the tips, mirrored. The middle elements are
/// `tipRefinement` (> 0) times as long as those at the tips; 1: all equal; below 1: short elements in the middle.
std::vector<double> gradedLengths(double length, int elements, double tipRefinement);

/// The number of equal elements, `atLeast` or up to three more, that puts a node nearest to this fraction of the
/// length. A support inside an element is a first-order error wherever the moments on its two sides differ, because an
/// element has one curvature (decision 0120). @param fraction 0 to 1
int elementsMeetingAt(double fraction, int atLeast);

/// Empty if the definition can be simulated, else what is wrong with it.
[[nodiscard]] std::string validate(const RodDefinition& definition);

/// An element, or half of the middle one, between mid-length and a tip; listed outwards.
struct Segment {
    int element = 0;
    int dof = 0;               ///< index of its curvature in q
    double innerS = 0.0;       ///< rod arc length of its inner end, m
    double signedLength = 0.0; ///< m, negative left of the middle
};

/// A part of a point mass. A body with inertia is two halves, rigidly before and behind its place.
struct CarriedPoint {
    int side = 0, segment = 0;
    double local = 0.0; ///< arc length from the segment's inner end, signed as the segment's, m
    double ahead = 0.0; ///< along the tangent there, m
    double mass = 0.0;  ///< kg
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
    [[nodiscard]] int elementOfDof(int dof) const;
    /// Length of one element, m.
    [[nodiscard]] double elementLength(int element) const { return lengths_[static_cast<std::size_t>(element)]; }
    [[nodiscard]] double longestElement() const { return longest_; }
    /// Of the mean natural curvature, m; of a nearly straight rod (less than 1 rad in all) as if it were three quarters
    /// of a circle.
    [[nodiscard]] double meanRadius() const { return radius_; }
    /// Arc length of node i (0 .. N) from the first tip, m.
    [[nodiscard]] double nodeS(int node) const { return nodeS_[static_cast<std::size_t>(node)]; }
    /// The element on which arc length s lies; at a node the element after it, beyond an end the end element.
    [[nodiscard]] int elementAt(double s) const;
    [[nodiscard]] double midS() const { return 0.5 * definition_.length; }
    [[nodiscard]] const RodDefinition& definition() const { return definition_; }
    [[nodiscard]] double mass() const { return mass_; }
    /// Points that carry the point masses, in the order of sides and segments.
    [[nodiscard]] const std::vector<CarriedPoint>& carried() const { return carried_; }
    /// Those of one segment: the first one, and the one after the last.
    [[nodiscard]] std::pair<std::size_t, std::size_t> carriedOn(int side, std::size_t segment) const {
        if (carried_.empty())
            return {0, 0};
        const std::size_t k = segment + (side == 0 ? 0 : sides_[0].size());
        return {firstCarried_[k], firstCarried_[k + 1]};
    }
    /// side 0: towards the last tip (s > mid), side 1: towards the first tip.
    [[nodiscard]] const std::vector<Segment>& side(int which) const { return sides_[which]; }
    /// Points at which the mass of the rod sits: Gauss points, then those that carry point masses.
    [[nodiscard]] int massPoints() const { return gaussPoints() + static_cast<int>(carried_.size()); }
    [[nodiscard]] int gaussPoints() const { return kGauss * static_cast<int>(sides_[0].size() + sides_[1].size()); }

private:
    void computeLengths();
    void carryPointMasses();

    RodDefinition definition_;
    int elements_ = 0;
    bool equal_ = true;
    std::vector<double> lengths_;
    std::vector<double> nodeS_;
    double longest_ = 0.0, radius_ = 0.0, mass_ = 0.0;
    std::vector<CarriedPoint> carried_;
    std::vector<std::size_t> firstCarried_; ///< of each segment; empty: there are none
    std::vector<Segment> sides_[2];
};

} // namespace supercircle::rod
