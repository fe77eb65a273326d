#include "plugin/bench/virtual_threads.h"

#include "plugin/bench/bench.h"

namespace supercircle::cli {

namespace {

constexpr std::array kOneLong{3.0, 1.0, 1.0, 1.0}, kEven{1.0, 1.0, 1.0, 1.0};
static_assert(makespan(kOneLong, 1) == 6.0 && makespan(kOneLong, 2) == 3.0 && makespan(kOneLong, 64) == 3.0);
static_assert(makespan(kEven, 2) == 2.0 && makespan(kEven, 3) == 2.0 && makespan(kEven, 4) == 1.0);

} // namespace

VirtualThreads::Cost& VirtualThreads::Cost::operator+=(const Cost& other) {
    total += other.total;
    inside += other.inside;
    loops += other.loops;
    for (std::size_t i = 0; i < span.size(); ++i)
        span[i] += other.span[i];
    return *this;
}

VirtualThreads::VirtualThreads() : since_(threadCpuSeconds()) {}

parallel::For VirtualThreads::loop() {
    return [this](std::size_t count, const std::function<void(std::size_t)>& body) {
        iterations_.clear();
        const double start = threadCpuSeconds();
        double before = start;
        for (std::size_t i = 0; i < count; ++i) {
            body(i);
            const double now = threadCpuSeconds();
            iterations_.push_back(now - before);
            before = now;
        }
        schedule(start, before);
    };
}

void VirtualThreads::schedule(double start, double end) {
    Cost& cost = costs_[static_cast<std::size_t>(stage_)];
    cost.total += end - since_;
    cost.inside += end - start;
    cost.loops += 1.0;
    for (std::size_t i = 0; i < kThreads.size(); ++i)
        cost.span[i] += makespan(iterations_, kThreads[i]);
    since_ = threadCpuSeconds();
}

void VirtualThreads::enter(step::Stage stage) {
    const double now = threadCpuSeconds();
    costs_[static_cast<std::size_t>(stage_)].total += now - since_;
    since_ = now;
    stage_ = stage;
}

const VirtualThreads::Costs& VirtualThreads::costs() {
    enter(stage_);
    return costs_;
}

void VirtualThreads::reset() {
    costs_ = {};
    since_ = threadCpuSeconds();
}

} // namespace supercircle::cli
