#pragma once
// Gathers the candidates of one pair, gives them their rank, drops coincident ones and puts them in order.

#include "supercircle/contact/detection/pieces.h"
#include "supercircle/contact/identity.h"

#include <vector>

namespace supercircle::contact {

class Collector {
public:
    /// Starts a pair. Candidates whose points agree to `tolerance` (m) on both sides are the same one.
    void begin(double tolerance);
    /// Adds a candidate with an id of rank 0. `u`, `v`, `w` locate its two points (m); `shared` tells that another
    /// candidate may sit on the same points.
    void add(const Candidate& candidate, double u, double v, double w, bool shared);
    /// Adds one whose id has a rank in its low bits (SampleRod, CornerRod): the rank counts those of equal id since the
    /// last call with a different sample. Calls for one sample follow each other, by growing arc length.
    void addRanked(const Candidate& candidate, double u, double v, double w, bool shared);
    /// Drops duplicates (samples are kept before interior minima, smaller ids before larger ones), sorts by id, makes
    /// ids unique and appends to `out`.
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
