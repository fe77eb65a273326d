#include "plugin/lab/session/run_scene.h"

#include "plugin/lab/session/session.h"

namespace supercircle::lab {

RunResult runScene(const scene::Scene& scene, std::shared_ptr<step::HostWorld> host, const RunOptions& options) {
    RunResult out;
    Session session(scene, std::move(host), options);
    if (std::string error = session.populate(); !error.empty()) {
        out.status = RunStatus::BadScene;
        out.message = error;
        return out;
    }
    if (scene.drop)
        session.drop();
    else if (scene.starts_at_rest)
        session.settleAtStart();
    if (session.status() == RunStatus::Done)
        session.runProtocol();
    out.status = session.status();
    out.message = session.message();
    out.recording = session.finish(out.status, out.message);
    return out;
}

} // namespace supercircle::lab
