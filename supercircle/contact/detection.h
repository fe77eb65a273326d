#pragma once
// From curves and outlines to contact candidates.

#include "supercircle/contact/geometry.h"
#include "supercircle/support/parallel.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace supercircle::contact {

/// A point on a rod's centre line.
struct RodPoint {
    std::int32_t rod = -1;     ///< index into the curves
    std::int32_t element = -1; ///< which arc
    double s = 0.0;            ///< arc length along the *rod*, m
};

/// One candidate. The frame is taken at the closest points: `normal` points from side B to side A (so that a positive
/// relative normal velocity of A against B opens), tangent = perp(normal).
struct Candidate {
    RodPoint a;                ///< always a rod
    RodPoint b;                ///< a rod, or rod = -1 when B is an outline
    std::int32_t outline = -1; ///< index into the outlines when B is rigid
    Vec2 normal = Vec2::UnitY();
    Vec2 pointA = Vec2::Zero(); ///< surface point of A: centre-line point - halfThickness * normal
    Vec2 pointB = Vec2::Zero(); ///< surface point of B
    double gap = 0.0;     ///< distance of centre lines (or outline) minus the half thicknesses; negative = overlap, m
    std::uint64_t id = 0; ///< stable from step to step while the same pair of features is meant; unique in one result
};

struct DetectionOptions {
    double margin = 1e-4; ///< speculative margin, m: candidates with gap <= margin + motion(A) + motion(B) are reported
};

/// Keeps acceleration structures between calls (cached candidate pairs with motion bounds); the *result* does not
/// depend on that history. Candidates come in an order that depends on keys and geometry only.
class Detector {
public:
    Detector();
    ~Detector();
    Detector(Detector&&) noexcept;
    Detector& operator=(Detector&&) noexcept;

    void detect(const std::vector<Curve>& curves, const std::vector<Outline>& outlines, const DetectionOptions& options,
                std::vector<Candidate>& out, const parallel::For& loop = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Re-evaluates one candidate after a small motion, keeping its feature pair: the sampled point (node, tip, mid,
/// corner) stays, its projection or the interior minimum is found again. Updates normal, points, s and gap; false if
/// the feature pair no longer exists (the candidate is then left as it was).
bool refresh(Candidate& c, const std::vector<Curve>& curves, const std::vector<Outline>& outlines);

} // namespace supercircle::contact
