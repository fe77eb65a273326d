#include "supercircle/contact/detection/candidate_reducer.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact {

namespace {

constexpr std::uint64_t kRankBits = 0x1ff; ///< of a sample payload (feature_id.h)
constexpr unsigned kSampleShift = 10;      ///< above side and rank

bool isInterior(std::uint64_t id) {
    const Feature kind = featureOf(id);
    return kind == Feature::Interior || kind == Feature::InteriorOutline;
}

} // namespace

void CandidateReducer::begin(double tolerance) {
    SC_ASSERT(!(tolerance < 0.0), "a tolerance is not negative");
    entries_.clear();
    tolerance_ = tolerance;
}

void CandidateReducer::add(const Candidate& candidate, double u, double v, double w, bool shared) {
    entries_.push_back({candidate, u, v, w, shared, false});
}

void CandidateReducer::addRanked(const Candidate& candidate, double u, double v, double w, bool shared) {
    SC_ASSERT((candidate.id & kRankBits) == 0, "the rank is given here");
    std::uint64_t rank = 0;
    for (std::size_t i = entries_.size(); i-- > 0;) {
        const std::uint64_t id = entries_[i].candidate.id;
        if ((id >> kSampleShift) != (candidate.id >> kSampleShift))
            break;
        if ((id & ~kRankBits) == candidate.id)
            ++rank;
    }
    add(candidate, u, v, w, shared);
    entries_.back().candidate.id |= std::min(rank, kRankBits);
}

bool CandidateReducer::same(const Entry& a, const Entry& b) const {
    return std::abs(a.u - b.u) <= tolerance_ && std::abs(a.v - b.v) <= tolerance_ && std::abs(a.w - b.w) <= tolerance_;
}

void CandidateReducer::finish(std::vector<Candidate>& out) {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        if (!entries_[i].shared || entries_[i].dropped)
            continue;
        for (std::size_t j = 0; j < entries_.size(); ++j) {
            if (j == i || entries_[j].dropped || !same(entries_[i], entries_[j]))
                continue;
            const std::uint64_t a = entries_[i].candidate.id;
            const std::uint64_t b = entries_[j].candidate.id;
            const bool dropFirst = isInterior(a) != isInterior(b) ? isInterior(a) : (a != b ? a > b : i > j);
            entries_[dropFirst ? i : j].dropped = true;
            if (dropFirst)
                break;
        }
    }
    order_.clear();
    for (std::size_t i = 0; i < entries_.size(); ++i)
        if (!entries_[i].dropped)
            order_.push_back(static_cast<std::uint32_t>(i));
    std::sort(order_.begin(), order_.end(), [this](std::uint32_t a, std::uint32_t b) {
        const std::uint64_t idA = entries_[a].candidate.id;
        const std::uint64_t idB = entries_[b].candidate.id;
        return idA != idB ? idA < idB : a < b;
    });
    const std::size_t first = out.size();
    for (const std::uint32_t i : order_) {
        out.push_back(entries_[i].candidate);
        // Equal ids: rods of more than 1023 elements, elements of more than two sub-arcs, more than 512 feet of a
        // sample. The new id may differ in the next step, which costs the warm start of that contact.
        if (out.size() > first + 1 && out.back().id <= out[out.size() - 2].id)
            out.back().id = out[out.size() - 2].id + 1;
    }
    SC_ASSERT(out.size() - first == order_.size() && order_.size() <= entries_.size(), "what is not dropped is kept");
    SC_ASSERT_EXPENSIVE(
        invariants::forAll(order_.size(),
                           [&](std::size_t i) { return i == 0 || out[first + i - 1].id < out[first + i].id; }),
        "the candidates of a pair are sorted by id");
}

} // namespace supercircle::contact
