#include "plugin/api/quality.h"

#include "plugin/api/shells_impl.h"
#include "plugin/api/snapshot_fields.h"

namespace supercircle {

step::Settings settingsFor(Quality quality, const step::Settings& before) {
    step::Settings s = quality == Quality::Game ? step::gameSettings() : step::Settings{};
    s.threads = before.threads;
    s.autoSleep = before.autoSleep;
    s.sleepDrift = before.sleepDrift;
    s.sleepAfter = before.sleepAfter;
    s.recoverAfter = before.recoverAfter;
    s.crossingCheck = true;
    return s;
}

Quality qualityOf(const step::Settings& settings) {
    return settings.cull ? Quality::Game : Quality::Laboratory;
}

Status Shells::set_quality(Quality quality) {
    return impl_->change([&] {
        if (quality != Quality::Laboratory && quality != Quality::Game)
            return refused("the quality must be Laboratory or Game");
        impl_->stepper.settings() = settingsFor(quality, impl_->stepper.settings());
        impl_->recorder.record(Call::SetQuality, quality);
        return done();
    });
}

Quality Shells::quality() const {
    return qualityOf(impl_->stepper.settings());
}

Status Shells::set_frame_budget(std::uint64_t work) {
    return impl_->change([&] {
        if (quality() != Quality::Game)
            return refused("only game quality has a frame budget");
        impl_->stepper.settings().frameWork = work;
        impl_->recorder.record(Call::SetFrameBudget, work);
        return done();
    });
}

Status Shells::set_crush_policy(CrushPolicy policy) {
    return impl_->change([&] {
        if (policy > CrushPolicy::Freeze)
            return refused("the policy must be Wait, Stop or Freeze");
        impl_->stepper.settings().crush = static_cast<step::CrushPolicy>(policy);
        impl_->recorder.record(Call::SetCrushPolicy, policy);
        return done();
    });
}

Status Shells::set_threads(int threads) {
    return impl_->change([&] {
        if (threads < 1 || threads > 256)
            return refused("the number of threads must lie between 1 and 256");
        impl_->stepper.settings().threads = threads;
        return done();
    });
}

} // namespace supercircle
