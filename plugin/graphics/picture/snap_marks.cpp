#include "plugin/graphics/picture/snap_marks.h"

#include <algorithm>
#include <cmath>

namespace supercircle::picture {

void SnapMarks::add(graphics::Point at, double joules, double time) {
    if (!(std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(joules)))
        return;
    if (entries_.size() >= kMostMarks)
        entries_.erase(entries_.begin());
    entries_.push_back({at, joules, time});
}

std::vector<SnapMark> SnapMarks::at(double clock, double time) {
    std::erase_if(entries_, [&](const Entry& e) { return e.fresh && !(std::abs(time - e.since) < kSnapLife); });
    if (clock < last_) {
        std::erase_if(entries_, [](const Entry& e) { return !e.fresh; });
        lastFlash_ = std::min(lastFlash_, clock); // no light for an interval after the jump
    }
    last_ = clock;
    // Of several new ones the largest flashes.
    Entry* largest = nullptr;
    for (Entry& e : entries_)
        if (e.fresh && (largest == nullptr || e.released > largest->released))
            largest = &e;
    if (largest != nullptr && clock - lastFlash_ >= kFlashInterval) {
        largest->flash = true;
        lastFlash_ = clock;
    }
    for (Entry& e : entries_)
        if (e.fresh) {
            e.fresh = false;
            e.since = clock;
        }
    std::erase_if(entries_, [&](const Entry& e) { return clock - e.since >= kSnapLife; });
    std::vector<SnapMark> shown;
    for (const Entry& e : entries_)
        shown.push_back({e.at, e.released, (clock - e.since) / kSnapLife, e.flash});
    return shown;
}

} // namespace supercircle::picture
