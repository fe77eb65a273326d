/* supercircle_box2d.h: shells in a Box2D 2.4.1 world that belongs to a C++ host. The rules are those of supercircle.h.
 *
 * The host keeps stepping its world: sc_world_pre_step(w, dt, &frame); world.Step(frame.advanced, 8, 3);
 * sc_world_post_step(w). Calls that name bodies work on the host's bodies, too. The b2World must outlive the sc_world.
 */
#ifndef SUPERCIRCLE_BOX2D_H
#define SUPERCIRCLE_BOX2D_H

#include "supercircle.h"

#ifdef __cplusplus
class b2Body;
class b2World;
#else
typedef struct b2Body b2Body;
typedef struct b2World b2World;
#endif

/// Shells in the host's world. Of the definition, iterations and gravity are ignored: they are the host's.
SC_API sc_status sc_world_attach(b2World* host, const sc_world_def* def, sc_world* out);
/// Advances the shells by dt (s) before the host steps by sc_frame::advanced. SC_FAILED as of sc_world_step.
SC_API sc_status sc_world_pre_step(sc_world w, double dt, sc_frame* out);
/// The same for a scene that was loaded into the world.
SC_API sc_status sc_scene_pre_step(sc_scene s, double dt, sc_frame* out);
/// After the host's step, also of a scene.
SC_API sc_status sc_world_post_step(sc_world w);
/// The handle of a host's body.
SC_API sc_status sc_body_of(sc_world w, const b2Body* body, sc_body* out);
/// The host's body of a handle, null if it is stale. Good until the host destroys it.
SC_API b2Body* sc_body_pointer(sc_world w, sc_body b);
/// Names a body for sc_body_find and sc_crosshead_attach.
SC_API sc_status sc_body_set_name(sc_world w, sc_body b, const char* name);
/// Call it before the host destroys a body.
SC_API sc_status sc_body_forget(sc_world w, sc_body b);

#endif
