#pragma once
// Collects the candidates of one pair, ranks equal ids, removes coincident candidates and sorts the rest.

#include "supercircle/contact/detection/sub_arcs.h"
#include "supercircle/contact/feature_id.h"

#include <vector>

namespace supercircle::contact {

class CandidateReducer {
public:
    /// Starts a pair. Candidates whose points agree to `tolerance` (m) on both sides are the same one.
    void begin(double tolerance);
    /// Adds a candidate whose id has no rank. `u`, `v`, `w` (m) locate its two points: arc lengths on both rods and 0,
    /// or the arc length on the rod and x, y on the outline. `shared`: another candidate may have the same points.
    void add(const Candidate& candidate, double u, double v, double w, bool shared);
    /// Adds a candidate whose id has a rank in its low bits (SampleRod, CornerRod). The rank counts equal ids since the
    /// last call with a different sample. Calls for one sample must be consecutive, by increasing arc length.
    void addRanked(const Candidate& candidate, double u, double v, double w, bool shared);
    /// Removes duplicates (samples take precedence over interior minima, smaller ids over larger ones), sorts by id,
    /// makes ids unique and appends to `out`.
    void finish(std::vector<Candidate>& out);

private:
    struct Entry {
        Candidate candidate;
        double u, v, w;
        bool shared;
        bool dropped;
    };
    [[nodiscard]] bool same(const Entry& a, const Entry& b) const;

    std::vector<Entry> entries_;
    std::vector<std::uint32_t> order_;
    double tolerance_ = 0.0;
};

} // namespace supercircle::contact
