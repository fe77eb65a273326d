#pragma once
// Contact detection: from rod curves and outlines to contact candidates.

#include "supercircle/contact/geometry.h"
#include "supercircle/support/parallel.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace supercircle::contact {

/// Extremal points inside elements count if the two sides separate by more than this fraction of the summed half
/// thicknesses within half an element. Nearer to conformal their place is round-off. With a larger fraction contacts of
/// stacks come and go at every step (decision 0054).
constexpr double kConditionedShare = 0.0002;

/// A point on the centre line of a rod.
struct RodPoint {
    std::int32_t rod = -1;     ///< index into the curves
    std::int32_t element = -1; ///< which arc
    double s = 0.0;            ///< arc length along the *rod*, m
};

/// One contact candidate. Its frame belongs to the closest points: `normal` points from side B to side A, tangent =
/// perp(normal). A positive relative normal velocity of A against B opens the contact.
struct Candidate {
    RodPoint a;                ///< always a rod
    RodPoint b;                ///< a rod, or rod = -1 when B is an outline
    std::int32_t outline = -1; ///< index into the outlines when B is rigid
    Vec2 normal = Vec2::UnitY();
    Vec2 pointA = Vec2::Zero(); ///< surface point of A, m: centre-line point - halfThickness * normal
    Vec2 pointB = Vec2::Zero(); ///< surface point of B, m
    double gap = 0.0;     ///< distance of centre lines (or outline) minus the half thicknesses; negative = overlap, m
    std::uint64_t id = 0; ///< same from step to step for the same pair of features; unique in one result
};

struct DetectionOptions {
    double margin = 1e-4; ///< speculative margin, m: candidates with gap <= margin + motion(A) + motion(B) are reported
};

/// Keeps acceleration structures between calls: cached pairs with motion bounds. The result does not depend on that
/// history, and the order of the candidates depends on keys and geometry only.
class Detector {
public:
    Detector();
    ~Detector();
    Detector(Detector&&) noexcept;
    Detector& operator=(Detector&&) noexcept;

    void detect(const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines,
                const DetectionOptions& options, std::vector<Candidate>& out, const parallel::For& loop = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Updates one candidate after a small motion, for the same pair of features. The sampled point (node, tip, mid,
/// corner) stays; its projection or the interior minimum is found again. Sets normal, points, s and gap. Returns false
/// and changes nothing if the pair of features no longer exists.
bool updateCandidate(Candidate& c, const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines);

} // namespace supercircle::contact
