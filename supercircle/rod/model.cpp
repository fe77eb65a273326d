#include "supercircle/rod/model.h"

#include <cmath>
#include <utility>

namespace supercircle::rod {

std::string validate(const RodDefinition& d) {
    const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
    if (d.naturalCurvature.empty())
        return "a rod needs at least one element (natural curvature is empty)";
    if (!positive(d.length))
        return "length must be positive and finite";
    if (!positive(d.thickness))
        return "thickness must be positive and finite";
    if (!positive(d.linearMass))
        return "linear mass must be positive and finite";
    if (!positive(d.bendingModulus))
        return "bending modulus must be positive and finite";
    if (d.thickness >= d.length)
        return "thickness must be smaller than the length";
    for (double k : d.naturalCurvature)
        if (!std::isfinite(k))
            return "natural curvature must be finite";
    return {};
}

RodModel::RodModel(RodDefinition definition) : definition_(std::move(definition)) {
    elements_ = static_cast<int>(definition_.naturalCurvature.size());
    elementLength_ = definition_.length / elements_;
    const int half = elements_ / 2;
    const double mid = midS();
    const bool odd = elements_ % 2 == 1;
    if (odd) {
        sides_[0].push_back({half, dofOfElement(half), mid, 0.5 * elementLength_});
        sides_[1].push_back({half, dofOfElement(half), mid, -0.5 * elementLength_});
    }
    for (int i = odd ? half + 1 : half; i < elements_; ++i)
        sides_[0].push_back({i, dofOfElement(i), i * elementLength_, elementLength_});
    for (int i = half - 1; i >= 0; --i)
        sides_[1].push_back({i, dofOfElement(i), (i + 1) * elementLength_, -elementLength_});
}

int RodModel::dofOfElement(int element) const {
    if (elements_ % 2 == 0)
        return element;
    const int half = elements_ / 2;
    if (element == half)
        return elements_ - 1;
    return element < half ? element : element - 1;
}

} // namespace supercircle::rod
