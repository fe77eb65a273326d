#include "supercircle/step/contacts/passed_tips.h"

#include "supercircle/contact/feature_id.h"
#include "supercircle/support/invariants.h"

namespace supercircle::step {

namespace {

/// Whether the foot of a node runs off a tip within the step; at its start it was at `start` m.
bool passesTip(const contact::Candidate& c, double start, const std::vector<contact::RodCurve>& curves) {
    if (contact::featureOf(c.id) != contact::Feature::SampleRod)
        return false;
    const contact::RodCurve& a = curves[static_cast<std::size_t>(c.a.rod)];
    const contact::RodCurve& b = curves[static_cast<std::size_t>(c.b.rod)];
    const bool isTip = !a.closed && (c.a.s <= a.nodeS.front() || c.a.s >= a.nodeS.back());
    const double end = 2.0 * c.b.s - start;
    return !isTip && !b.closed && (end < b.nodeS.front() || end > b.nodeS.back());
}

} // namespace

void leaveOutPassedTips(const std::vector<contact::Candidate>& start, const std::vector<contact::RodCurve>& curves,
                        std::vector<contact::Candidate>& candidates, std::vector<double>& gaps) {
    SC_ASSERT(candidates.size() >= start.size() && gaps.size() == candidates.size(), "one gap a candidate");
    std::size_t kept = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (i < start.size() && passesTip(candidates[i], start[i].b.s, curves))
            continue;
        candidates[kept] = candidates[i];
        gaps[kept++] = gaps[i];
    }
    candidates.resize(kept);
    gaps.resize(kept);
}

} // namespace supercircle::step
