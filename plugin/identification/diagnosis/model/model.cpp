#include "plugin/identification/diagnosis/model/model.h"

#include "supercircle/support/elementary.h"

#include <cmath>

namespace supercircle::diagnosis {

double toPhysical(Scale scale, double x) {
    switch (scale) {
    case Scale::Reciprocal:
        return x > 0.0 ? 1.0 / x : std::numeric_limits<double>::infinity();
    case Scale::ReciprocalSquare:
        return x > 0.0 ? 1.0 / std::sqrt(x) : std::numeric_limits<double>::infinity();
    case Scale::Logarithm:
        return math::exp(x);
    case Scale::Linear:
        break;
    }
    return x;
}

double toInternal(Scale scale, double x) {
    switch (scale) {
    case Scale::Reciprocal:
        return 1.0 / x;
    case Scale::ReciprocalSquare:
        return 1.0 / (x * x);
    case Scale::Logarithm:
        return math::log(x);
    case Scale::Linear:
        break;
    }
    return x;
}

ParameterPoint statedPoint(const Model& model) {
    ParameterPoint point;
    for (const Scalar& s : model.nominal())
        point.nominal.push_back(s.value);
    return point;
}

} // namespace supercircle::diagnosis
