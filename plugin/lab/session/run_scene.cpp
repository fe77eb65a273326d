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
    if (!options.checkpoint.resume.empty())
        if (const Status restored = session.restoreState(options.checkpoint.resume); !restored) {
            out.status = RunStatus::BadScene;
            out.message = restored.error();
            return out;
        }
    if (session.beforeProtocol() && scene.drop)
        session.drop();
    else if (session.beforeProtocol() && scene.starts_at_rest)
        session.settleAtStart();
    if (session.status() == RunStatus::Done)
        session.runProtocol();
    out.status = session.status();
    out.message = session.message();
    out.recording = session.finish(out.status, out.message);
    if (options.checkpoint.file && out.status == RunStatus::Done)
        options.checkpoint.file->remove();
    return out;
}

} // namespace supercircle::lab
