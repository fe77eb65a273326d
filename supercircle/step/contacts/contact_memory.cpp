#include "supercircle/step/contact_memory.h"

#include "supercircle/contact/feature_id.h"

#include <algorithm>

namespace supercircle::step {

const ContactImpulse* findImpulse(const std::vector<ContactImpulse>& list, std::uint64_t id) {
    const auto it = std::lower_bound(list.begin(), list.end(), id,
                                     [](const ContactImpulse& a, std::uint64_t want) { return a.id < want; });
    return it != list.end() && it->id == id ? &*it : nullptr;
}

void sortById(std::vector<ContactImpulse>& list) {
    std::sort(list.begin(), list.end(), [](const ContactImpulse& a, const ContactImpulse& b) { return a.id < b.id; });
}

void sortedIds(const std::vector<contact::Candidate>& candidates, std::vector<std::uint64_t>& ids) {
    ids.clear();
    for (const contact::Candidate& c : candidates)
        ids.push_back(c.id);
    std::sort(ids.begin(), ids.end());
}

ContactImpulse forceBefore(const std::vector<ContactImpulse>& list, const std::vector<std::uint64_t>& present,
                           const contact::Candidate& c) {
    if (const ContactImpulse* own = findImpulse(list, c.id))
        return *own;
    ContactImpulse sum;
    const contact::Feature kind = contact::featureOf(c.id);
    if (kind != contact::Feature::Interior && kind != contact::Feature::InteriorOutline)
        return sum;
    const auto first = static_cast<std::int64_t>((c.id >> 11U) & 0x3ffu),
               second = static_cast<std::int64_t>((c.id >> 1U) & 0x3ffu);
    const std::int64_t reach = kind == contact::Feature::Interior ? 1 : 0; // faces do not join smoothly
    for (std::int64_t i = first - 1; i <= first + 1; ++i)
        for (std::int64_t j = second - reach; j <= second + reach; ++j)
            for (std::uint64_t part = 0; part < 2 && i >= 0 && j >= 0; ++part) {
                const std::uint64_t id = (c.id & ~std::uint64_t{0x1fffff}) | (static_cast<std::uint64_t>(i) << 11U) |
                                         (static_cast<std::uint64_t>(j) << 1U) | part;
                const ContactImpulse* other = findImpulse(list, id);
                if (other && !std::binary_search(present.begin(), present.end(), id)) {
                    sum.normal += other->normal;
                    sum.tangent += other->tangent;
                }
            }
    return sum;
}

} // namespace supercircle::step
