/* supercircle.h: flexible shells from C99 and from every language that can call C. SI units, angles in rad.
 *
 * 1 A call returns sc_status (0: done) or a count (negative: minus a status). A refused call has changed nothing, and
 *   sc_error() says what is wrong and what to do. No exception, assertion or exit of the library reaches the caller.
 *   Calls that return a number or a text return NaN, 0 or null when they are refused.
 * 2 Handles are values with a generation; zero is null. A stale, foreign or destroyed one gives SC_STALE.
 * 3 The caller owns what it passes in (copied during the call) and the buffers it passes for results: at most
 *   `capacity` items are written, and the number there would be is returned. Texts that the library returns stay good
 *   until the same thread has got four more; that of sc_error() until its next call. `bytes` of a text may be -1: up to
 *   its zero.
 * 4 Definitions are filled by their _init call, which also sets `size`; later versions only append members and calls.
 *   Other structs never change. No struct holds a pointer, size_t or bool: layouts are the same in WebAssembly.
 * 5 Different worlds may be used by different threads at once. A world that another thread is in answers SC_BUSY.
 */
#ifndef SUPERCIRCLE_H
#define SUPERCIRCLE_H

#include <stdint.h>

#ifndef SC_API
#if defined(__cplusplus)
#define SC_API extern "C"
#else
#define SC_API extern
#endif
#endif

/// Version of the binary interface: sc_api_version() of the library must be equal.
#define SC_API_VERSION 1

/* ---- handles */

typedef struct sc_world {
    uint64_t id;
} sc_world;
typedef struct sc_shell {
    uint64_t id;
} sc_shell;
typedef struct sc_body {
    uint64_t id;
} sc_body;
typedef struct sc_hold {
    uint64_t id;
} sc_hold;
typedef struct sc_joint {
    uint64_t id;
} sc_joint;
typedef struct sc_mouse_joint {
    uint64_t id;
} sc_mouse_joint;
typedef struct sc_force {
    uint64_t id;
} sc_force;
typedef struct sc_zone {
    uint64_t id;
} sc_zone;
typedef struct sc_scene {
    uint64_t id;
} sc_scene;

/* ---- constants */

typedef int32_t sc_status;
enum {
    SC_OK,
    SC_BAD_INPUT,    ///< a null pointer, a number that is not finite or out of range, an unknown name, bad JSON
    SC_STALE,        ///< the handle is null, stale or of another world
    SC_BUSY,         ///< another thread is inside this world
    SC_REFUSED,      ///< the input is fine, but the present state does not allow it
    SC_FAILED,       ///< the simulation could not go on, or an internal check failed
    SC_NO_MEMORY,    ///< out of memory
    SC_WRONG_VERSION ///< a definition of a newer version than the library
};
enum { SC_QUALITY_LABORATORY, SC_QUALITY_GAME };
enum { SC_HOLD_PIN, SC_HOLD_CLAMP };
enum { SC_BASE_FIXED, SC_BASE_MOVING };
enum { SC_JOINT_PIN, SC_JOINT_WELD, SC_JOINT_TETHER };
enum { SC_CRUSH_WAIT, SC_CRUSH_STOP, SC_CRUSH_FREEZE };
enum { SC_BODY_STATIC, SC_BODY_KINEMATIC, SC_BODY_DYNAMIC };
enum {
    SC_SHAPE_BOX,     ///< `width` times `height` about the body's origin
    SC_SHAPE_CIRCLE,  ///< of `radius` about the body's origin
    SC_SHAPE_POLYGON, ///< 3 to 8 points, convex
    SC_SHAPE_LINE     ///< 2 or more points, solid from both sides; without mass
};
enum { SC_QUARANTINE_NOT_FINITE, SC_QUARANTINE_RUNAWAY, SC_QUARANTINE_CRUSHED };
enum {
    SC_CONTACT_BEGIN,
    SC_CONTACT_END,
    SC_IMPULSE,
    SC_SNAP_BEGIN,
    SC_SNAP_END,
    SC_QUARANTINED,
    SC_CRUSHED,
    SC_BROKE,
    SC_OVERLAP,
    SC_HOLD_BLOCKED,
    SC_ZONE_ENTER,
    SC_ZONE_LEAVE
};
enum {
    SC_LAYER_BODIES = 1,
    SC_LAYER_SHELLS = 2,
    SC_LAYER_STRAIN = 4,
    SC_LAYER_CONTACTS = 8,
    SC_LAYER_FORCES = 16,
    SC_LAYER_HOLDS = 32,
    SC_LAYER_SNAPS = 64
};

/* ---- structs */

typedef struct sc_point {
    double x; ///< m, m/s or N
    double y; ///< m, m/s or N
} sc_point;
typedef struct sc_world_def {
    int32_t size;                ///< set by sc_world_def_init
    int32_t quality;             ///< SC_QUALITY_...
    int32_t threads;             ///< that a step may use, 1 to 256; results do not depend on it
    int32_t velocity_iterations; ///< of Box2D
    int32_t position_iterations; ///< of Box2D
    int32_t reserved;            ///< 0
    sc_point gravity;            ///< m/s^2
    double units_per_metre;      ///< Box2D length units per metre; about 50 for bodies of some centimetres
} sc_world_def;
typedef struct sc_frame {
    double advanced;          ///< s; less than dt if out of budget or failed
    double work;              ///< in units of sc_world_set_frame_budget
    double injected;          ///< by closing gaps, J
    double energy_gained;     ///< alarm: energy that nobody gave, J
    uint64_t steps;           ///< inner steps of all islands
    uint64_t unconverged;     ///< of them above the contact tolerance
    int32_t budget_exhausted; ///< 1: the rest of dt was left out
    int32_t quarantined;      ///< shells in quarantine
    int32_t left_out;         ///< 1: bodies or gravity with numbers that are not finite were left out
    int32_t reserved;
} sc_frame;
typedef struct sc_energy {
    double kinetic;             ///< of the shells, J
    double bending;             ///< elastic, of the shells, J
    double gravity;             ///< potential, of the shells, J
    double added;               ///< by creating, destroying, moving and changing shells, J
    double work;                ///< by holds, joints, forces and driven bodies, J
    double friction;            ///< dissipated, J
    double impact;              ///< dissipated, J
    double numerical;           ///< dissipated by the time integration, J
    double position_correction; ///< added by correcting penetrations and gaps, J
    double injected;            ///< part of position_correction that closing gaps brought in, J
    double effects;             ///< dissipated, J
    double damping;             ///< dissipated by damping_ratio, J
    double to_bodies;           ///< passed to dynamic bodies, J
    double residual;            ///< what the terms leave unexplained, J
} sc_energy;
typedef struct sc_sleep {
    int32_t automatic; ///< 1: shells at rest fall asleep with the bodies on them
    int32_t reserved;
    double drift; ///< largest displacement within `delay`, in thicknesses, 1
    double delay; ///< s
} sc_sleep;
typedef struct sc_recovery {
    int32_t release; ///< 1: a quarantined shell moves again after a time
    int32_t reserved;
    double after; ///< s
} sc_recovery;
typedef struct sc_shell_def {
    int32_t size;          ///< set by sc_shell_def_init
    int32_t elements;      ///< number of arcs
    int32_t closed;        ///< 1: a ring
    int32_t reserved;      ///< 0
    sc_point position;     ///< of the middle of the shell, m
    double angle;          ///< of the tangent at the middle, rad
    double opening;        ///< opening angle / 2 pi, 1; used when length is 0
    double radius;         ///< natural radius, m; infinite: a straight strip
    double length;         ///< m; 0: opening angle times radius
    double thickness;      ///< m
    double width;          ///< m
    double density;        ///< kg/m^3
    double young_modulus;  ///< Pa
    double friction;       ///< coefficient, 1
    double damping_ratio;  ///< of the first mode, 1; negative: the default of the quality
    double tip_refinement; ///< length of the middle arcs over that of the tip arcs, 1
    sc_point velocity;     ///< m/s
    double spin;           ///< rad/s
    uint64_t user_data;
    uint32_t category; ///< collision filter as in Box2D, 16 bits
    uint32_t mask;     ///< 16 bits
    int32_t group;     ///< 16 bits
    uint32_t material; ///< friction material; 0: none
} sc_shell_def;
typedef struct sc_shell_state {
    double length;           ///< m
    double mass;             ///< kg
    sc_point centre;         ///< of mass, m
    sc_point momentum;       ///< kg m/s
    double angular_momentum; ///< about the centre of mass, kg m^2/s
    double kinetic;          ///< J
    double stored;           ///< elastic, J
    double max_strain;       ///< at the surface, 1
    sc_point lower;          ///< of the box around it, m
    sc_point upper;          ///< m
    int32_t quarantined;
    int32_t asleep;
} sc_shell_state;
typedef struct sc_section {
    sc_point position;        ///< of the centre line, m
    sc_point tangent;         ///< unit vector towards the last end
    double angle;             ///< of the tangent, continuous along the shell, rad
    sc_point velocity;        ///< m/s
    double spin;              ///< rad/s
    double curvature;         ///< 1/m
    double natural_curvature; ///< 1/m
    double moment;            ///< bending moment, N m
    double strain;            ///< largest over the thickness, 1
    double energy_density;    ///< J/m
} sc_section;
typedef struct sc_material {
    double friction;      ///< coefficient, 1; NaN: as it is
    double young_modulus; ///< Pa; NaN: as it is
    double density;       ///< kg/m^3; NaN: as it is
    double damping_ratio; ///< 1; NaN: as it is
} sc_material;
typedef struct sc_filter {
    uint32_t category; ///< 16 bits
    uint32_t mask;     ///< 16 bits
    int32_t group;     ///< 16 bits
    int32_t reserved;
} sc_filter;
typedef struct sc_target {
    sc_point position; ///< m
    double angle;      ///< rad, not modulo 2 pi; clamps only
    sc_point velocity; ///< at and after the end of the frame, m/s
    double spin;       ///< rad/s; clamps only
} sc_target;
typedef struct sc_reaction {
    sc_point force; ///< on the shell, N
    double torque;  ///< on the shell's section, N m
} sc_reaction;
typedef struct sc_joint_def {
    int32_t size;              ///< set by sc_joint_def_init
    int32_t kind;              ///< SC_JOINT_...
    sc_shell shell;            ///< the joined shell
    sc_shell other;            ///< the other end: a shell, if not null ...
    sc_body body;              ///< ... a body, if not null, else the world
    double arc_fraction;       ///< place on `shell`, 0 to 1
    double other_fraction;     ///< place on `other`, 0 to 1
    sc_point point;            ///< of a tether: place of its other end, m
    double length;             ///< of a tether, m; 0: the present distance
    int32_t collide_connected; ///< 1: the two collide with each other
    int32_t reserved;          ///< 0
} sc_joint_def;
typedef struct sc_mouse_joint_def {
    int32_t size; ///< set by sc_mouse_joint_def_init
    int32_t reserved;
    double arc_fraction;  ///< place on the shell, 0 to 1
    sc_point target;      ///< m
    double frequency;     ///< of the shell's mass on that spring, Hz
    double damping_ratio; ///< 1
    double max_force;     ///< N; 0: mass times 1000 m/s^2
} sc_mouse_joint_def;
typedef struct sc_hit {
    sc_shell shell;
    sc_point point;      ///< on the surface, m
    sc_point normal;     ///< unit vector out of the shell
    double fraction;     ///< of the ray, 0 to 1
    double arc_fraction; ///< of the closest point of the centre line
    double distance;     ///< of the given point from the surface, negative inside, m; 0 for rays
} sc_hit;
typedef struct sc_event {
    int32_t kind;   ///< SC_CONTACT_BEGIN ...; what a kind does not have is 0
    int32_t reason; ///< SC_QUARANTINE_...; SC_HOLD_BLOCKED: 1 if the target came to rest; no body: by another hold
    double time;    ///< s
    sc_shell a;
    sc_shell b; ///< null: a body
    sc_body body;
    sc_zone zone;
    sc_hold hold;
    sc_joint joint;
    double arc_a; ///< arc fraction on a
    double arc_b;
    sc_point point;          ///< m
    sc_point normal;         ///< towards a
    sc_point force;          ///< SC_BROKE: on the shell, N
    double approach_speed;   ///< m/s
    double normal_impulse;   ///< N s
    double friction_impulse; ///< N s
    double peak_force;       ///< N
    double energy_released;  ///< J
    double kinetic_peak;     ///< J
} sc_event;
typedef struct sc_event_settings {
    double impulse_threshold; ///< N s; infinite: no impulse events
    double snap_energy;       ///< least energy released, in B / L, 1
    double snap_time;         ///< in L^2 sqrt(lambda / B), 1
} sc_event_settings;
typedef struct sc_body_def {
    int32_t size;           ///< set by sc_body_def_init
    int32_t type;           ///< SC_BODY_...
    int32_t shape;          ///< SC_SHAPE_...
    int32_t fixed_rotation; ///< 1: it does not turn
    sc_point position;      ///< of its origin, m
    double angle;           ///< rad
    sc_point velocity;      ///< m/s
    double spin;            ///< rad/s
    double width;           ///< of a box, m
    double height;          ///< of a box, m
    double radius;          ///< of a circle, m
    double density;         ///< kg/m^2
    double friction;        ///< coefficient, 1
    double restitution;     ///< between bodies; shells ignore it, 1
    double linear_damping;  ///< 1/s
    double angular_damping; ///< 1/s
    double gravity_scale;   ///< 1
    uint32_t category;      ///< collision filter as in Box2D, 16 bits
    uint32_t mask;          ///< 16 bits
    int32_t group;          ///< 16 bits
    int32_t bullet;         ///< 1: fast ones do not pass other dynamic bodies
} sc_body_def;
typedef struct sc_body_state {
    sc_point centre;   ///< of mass, m
    double angle;      ///< rad
    sc_point velocity; ///< m/s
    double spin;       ///< rad/s
    double mass;       ///< kg; 0: does not yield
    double inertia;    ///< about the centre of mass, kg m^2
    int32_t type;      ///< SC_BODY_...
    int32_t awake;
} sc_body_state;
typedef struct sc_view {
    int32_t size;            ///< set by sc_view_init
    int32_t width;           ///< px
    int32_t height;          ///< px
    int32_t layers;          ///< sum of SC_LAYER_...
    sc_point centre;         ///< m
    double pixels_per_metre; ///< 0: everything fits
    double alpha;            ///< shells between the start (0) and the end (1) of the last frame
    double pixel_ratio;      ///< of line widths, marks and texts to those of an ordinary screen, 1
    double clock;            ///< of the viewer, by which flashes fade, s; 0: simulated time
    int32_t reduced_motion;  ///< 1: no flashes
    int32_t reserved;
} sc_view;

/* ---- library */

/// SC_API_VERSION of the library.
SC_API int32_t sc_api_version(void);
/// Version of the program, such as "0.2.0".
SC_API const char* sc_version(void);
/// Why this thread's last call was refused: one sentence, or one line a problem. Empty if it was not. sc_version,
/// sc_api_version and calls without a result cannot be refused and leave it as it is.
SC_API const char* sc_error(void);
/// Its status; says more than the NaN, 0 or null of a refused call.
SC_API sc_status sc_error_status(void);
/// Memory for languages without their own; null if there is none.
SC_API void* sc_alloc(int32_t bytes);
/// Frees memory of sc_alloc; null is allowed.
SC_API void sc_free(void* memory);
/// Size of all structs and offsets of their members as JSON.
SC_API const char* sc_layout(void);

/* ---- world: shells and rigid bodies (Box2D inside); supercircle_box2d.h attaches to a b2World of yours instead */

/// Earth's gravity, one Box2D unit a metre, one thread, laboratory quality.
SC_API void sc_world_def_init(sc_world_def* def);
/// At most 4095 worlds exist at a time.
SC_API sc_status sc_world_create(const sc_world_def* def, sc_world* out);
/// Its shells, bodies, scenes and handles end with it.
SC_API sc_status sc_world_destroy(sc_world w);
/// 1 if the handle names a world.
SC_API int32_t sc_world_valid(sc_world w);
/// Advances shells and bodies by dt (s); 0 is a pause. SC_FAILED: the shells could not go on; `out` is filled, too.
SC_API sc_status sc_world_step(sc_world w, double dt, sc_frame* out);
/// Texts of the last frame as JSON: "failure", "why", "refused", "note" (empty: nothing to say). After sc_world_add and
/// sc_scene_load: "note" has the notes of the text, one a line.
SC_API const char* sc_world_report(sc_world w);
/// Laboratory or game; settings of the numerics are reset.
SC_API sc_status sc_world_set_quality(sc_world w, int32_t quality);
/// SC_QUALITY_...
SC_API int32_t sc_world_quality(sc_world w);
/// Work per frame, about 1 us of a core each; 0: no limit. Game quality only.
SC_API sc_status sc_world_set_frame_budget(sc_world w, uint64_t work);
/// What becomes of crushed shells: SC_CRUSH_...
SC_API sc_status sc_world_set_crush_policy(sc_world w, int32_t policy);
/// What becomes of quarantined shells.
SC_API sc_status sc_world_set_recovery(sc_world w, const sc_recovery* to);
SC_API sc_status sc_world_recovery(sc_world w, sc_recovery* out);
/// Threads that a step may use, 1 to 256.
SC_API sc_status sc_world_set_threads(sc_world w, int32_t threads);
/// Gravity (m/s^2).
SC_API sc_status sc_world_set_gravity(sc_world w, sc_point gravity);
SC_API sc_status sc_world_gravity(sc_world w, sc_point* out);
SC_API sc_status sc_world_set_sleep(sc_world w, const sc_sleep* to);
SC_API sc_status sc_world_sleep(sc_world w, sc_sleep* out);
/// Friction coefficient between two friction materials, neither 0; negative: back to the geometric mean.
SC_API sc_status sc_world_set_friction(sc_world w, uint32_t a, uint32_t b, double friction);
/// Moves the origin of the coordinates to a point (m, in the old ones).
SC_API sc_status sc_world_shift_origin(sc_world w, sc_point origin);
/// Simulated time, s.
SC_API double sc_world_time(sc_world w);
/// Hash of the shells' state; equal states have equal hashes on every machine. 0: refused.
SC_API uint64_t sc_world_hash(sc_world w);
SC_API sc_status sc_world_energy(sc_world w, sc_energy* out);
/// All shells in the order of creation.
SC_API int32_t sc_world_shells(sc_world w, sc_shell* out, int32_t capacity);
/// The first shell of that name.
SC_API sc_status sc_world_find_shell(sc_world w, const char* name, sc_shell* out);

/* ---- shells */

/// The paper's shell: PET-G, R = 19.2 mm, h = 0.5 mm, opening 0.75.
SC_API void sc_shell_def_init(sc_shell_def* def);
/// For games: a shell of any `radius` (m) and `mass` (kg) that sags, rolls and snaps under 9.81 m/s^2 as the paper's
/// does. Its width is 1 m. `opening` as in the definition; `stiffness` (1) multiplies the bending stiffness.
SC_API sc_status sc_shell_def_scaled_init(sc_shell_def* def, double radius, double mass, double opening,
                                          double stiffness);
/// `name` and `natural_curvature` (1/m, one for all elements or one each) may be null; `count` is of the curvatures.
SC_API sc_status sc_shell_create(sc_world w, const sc_shell_def* def, const char* name, const double* natural_curvature,
                                 int32_t count, sc_shell* out);
/// The same with the curvature (1/m, one each) that it starts with.
SC_API sc_status sc_shell_create_bent(sc_world w, const sc_shell_def* def, const char* name,
                                      const double* natural_curvature, int32_t count, const double* curvature,
                                      int32_t curvature_count, sc_shell* out);
/// 1: such a shell crosses nothing there; 0: it does. Negative: minus a status.
SC_API int32_t sc_shell_fits(sc_world w, const sc_shell_def* def);
SC_API sc_status sc_shell_destroy(sc_world w, sc_shell s);
/// 1 if the handle names a shell of this world.
SC_API int32_t sc_shell_valid(sc_world w, sc_shell s);
/// The whole pose: curvature of each element (1/m), position and angle of the first end (may be null). `alpha` as of
/// sc_view, 1: at present.
SC_API int32_t sc_shell_curvatures(sc_world w, sc_shell s, double alpha, sc_target* first_end, double* out,
                                   int32_t capacity);
/// The centre line as a polyline that deviates from it by at most `tolerance` (m).
SC_API int32_t sc_shell_polyline(sc_world w, sc_shell s, double tolerance, sc_point* out, int32_t capacity);
SC_API sc_status sc_shell_state_of(sc_world w, sc_shell s, sc_shell_state* out);
/// At a place along the shell, 0 to 1.
SC_API sc_status sc_shell_section(sc_world w, sc_shell s, double arc, sc_section* out);
/// Moves the middle of the shell to a position (m) with its tangent at an angle (rad).
SC_API sc_status sc_shell_teleport(sc_world w, sc_shell s, sc_point position, double angle);
/// Velocity (m/s) of the middle and spin (rad/s) of a rigid motion.
SC_API sc_status sc_shell_set_velocity(sc_world w, sc_shell s, sc_point velocity, double spin);
SC_API sc_status sc_shell_set_material(sc_world w, sc_shell s, const sc_material* change);
/// 1/m, one for all elements or one each.
SC_API sc_status sc_shell_set_natural_curvature(sc_world w, sc_shell s, const double* curvature, int32_t count);
SC_API sc_status sc_shell_set_friction_material(sc_world w, sc_shell s, uint32_t material);
SC_API sc_status sc_shell_set_filter(sc_world w, sc_shell s, const sc_filter* filter);
SC_API sc_status sc_shell_filter(sc_world w, sc_shell s, sc_filter* out);
/// 0 puts its island to sleep, else wakes it.
SC_API sc_status sc_shell_set_awake(sc_world w, sc_shell s, int32_t awake);
SC_API const char* sc_shell_name(sc_world w, sc_shell s);
SC_API sc_status sc_shell_set_name(sc_world w, sc_shell s, const char* name);
SC_API sc_status sc_shell_user_data(sc_world w, sc_shell s, uint64_t* out);
SC_API sc_status sc_shell_set_user_data(sc_world w, sc_shell s, uint64_t data);
/// Force (N) and torque (N m) at a place during the coming step; several add up.
SC_API sc_status sc_shell_apply_force(sc_world w, sc_shell s, double arc, sc_point force, double torque);
/// Impulse (N s) and angular impulse (N m s) at a place, at once.
SC_API sc_status sc_shell_apply_impulse(sc_world w, sc_shell s, double arc, sc_point impulse, double angular);

/* ---- effects: physics beyond inextensible rods, linear bending and Coulomb friction */

/// The catalogue as JSON: key, slot, about, law, parameters.
SC_API const char* sc_effects(void);
/// Replaces all effects by a list as "effects" of a scene: [{"key": "planar_drag", "f_N_m": 0.2}]. A null shell: all.
SC_API sc_status sc_shell_set_effects(sc_world w, sc_shell s, const char* json);
/// Switches one effect on or changes it: {"key": "planar_drag", "f_N_m": 0.2}. A null shell: all.
SC_API sc_status sc_shell_set_effect(sc_world w, sc_shell s, const char* json);
/// Removes one effect. A null shell: all.
SC_API sc_status sc_shell_remove_effect(sc_world w, sc_shell s, const char* key);
/// The effects of a shell with all their values, as JSON.
SC_API const char* sc_shell_effects(sc_world w, sc_shell s);

/* ---- holds: a point of a shell that is fixed or driven */

/// Holds the point at `arc` (0 to 1) where it is. `kind`: SC_HOLD_...; `base`: SC_BASE_...
SC_API sc_status sc_hold_create(sc_world w, sc_shell s, double arc, int32_t kind, int32_t base, sc_hold* out);
SC_API int32_t sc_hold_valid(sc_world w, sc_hold h);
/// Target at the end of the coming frame; SC_BASE_FIXED only.
SC_API sc_status sc_hold_set_target(sc_world w, sc_hold h, const sc_target* to);
SC_API sc_status sc_hold_target(sc_world w, sc_hold h, sc_target* out);
SC_API sc_status sc_hold_reaction(sc_world w, sc_hold h, sc_reaction* out);
/// Largest force, N; 0: any. A hold that needed more breaks (SC_BROKE).
SC_API sc_status sc_hold_set_max_force(sc_world w, sc_hold h, double force);
SC_API sc_status sc_hold_destroy(sc_world w, sc_hold h);

/* ---- joints of shells with shells, bodies and the world */

SC_API void sc_joint_def_init(sc_joint_def* def);
/// Joins two points in their present positions; making a joint moves nothing.
SC_API sc_status sc_joint_create(sc_world w, const sc_joint_def* def, sc_joint* out);
SC_API int32_t sc_joint_valid(sc_world w, sc_joint j);
/// Target of the point a tether to the world is tied to.
SC_API sc_status sc_joint_set_target(sc_world w, sc_joint j, const sc_target* to);
SC_API sc_status sc_joint_target(sc_world w, sc_joint j, sc_target* out);
/// Makes a tether longer or shorter at `rate` (m/s) until it has `length` (m).
SC_API sc_status sc_joint_set_max_length(sc_world w, sc_joint j, double length, double rate);
/// Present length of a tether, m.
SC_API double sc_joint_length(sc_world w, sc_joint j);
SC_API sc_status sc_joint_reaction(sc_world w, sc_joint j, sc_reaction* out);
/// Largest force, N; 0: any. A joint that needed more breaks (SC_BROKE).
SC_API sc_status sc_joint_set_max_force(sc_world w, sc_joint j, double force);
SC_API sc_status sc_joint_destroy(sc_world w, sc_joint j);

/* ---- mouse joints: a soft spring to a target, on a shell or on a body */

SC_API void sc_mouse_joint_def_init(sc_mouse_joint_def* def);
SC_API sc_status sc_mouse_joint_create(sc_world w, sc_shell s, const sc_mouse_joint_def* def, sc_mouse_joint* out);
/// Grabs the dynamic body at a point (m) with at most `max_force` (N; 0: mass times 1000 m/s^2).
SC_API sc_status sc_body_grab(sc_world w, sc_point at, double max_force, sc_mouse_joint* out);
SC_API int32_t sc_mouse_joint_valid(sc_world w, sc_mouse_joint m);
SC_API sc_status sc_mouse_joint_move(sc_world w, sc_mouse_joint m, sc_point target);
/// Of a grabbed body: force on the body, mean over the last step.
SC_API sc_status sc_mouse_joint_reaction(sc_world w, sc_mouse_joint m, sc_reaction* out);
SC_API sc_status sc_mouse_joint_destroy(sc_world w, sc_mouse_joint m);

/* ---- lasting forces */

/// Force (N) and torque (N m) at a place of a shell until it is changed or destroyed.
SC_API sc_status sc_force_create(sc_world w, sc_shell s, double arc, sc_point force, double torque, sc_force* out);
SC_API int32_t sc_force_valid(sc_world w, sc_force f);
SC_API sc_status sc_force_set(sc_world w, sc_force f, sc_point force, double torque);
SC_API sc_status sc_force_destroy(sc_world w, sc_force f);

/* ---- rigid bodies: made from a definition, or from scene JSON (several shapes, joints), then moved by handle */

/// A dynamic box of 1 kg/m^2 without a size, friction 0.2.
SC_API void sc_body_def_init(sc_body_def* def);
/// A body of one shape. `points` (m, from its origin) are those of a polygon or line, else null; `name` may be null.
SC_API sc_status sc_body_create(sc_world w, const sc_body_def* def, const char* name, const sc_point* points,
                                int32_t count, sc_body* out);
/// Adds the bodies, joints, shells, holds and effects of a scene; the world keeps its gravity and scale. A fragment has
/// no drop, protocol or game. All problems stand in sc_error(), one a line.
SC_API sc_status sc_world_add(sc_world w, const char* json, int32_t bytes);
SC_API sc_status sc_body_find(sc_world w, const char* name, sc_body* out);
/// All bodies, oldest first.
SC_API int32_t sc_world_bodies(sc_world w, sc_body* out, int32_t capacity);
SC_API int32_t sc_body_valid(sc_world w, sc_body b);
SC_API sc_status sc_body_state_of(sc_world w, sc_body b, sc_body_state* out);
/// Position of the centre of mass (m) and angle (rad).
SC_API sc_status sc_body_set_pose(sc_world w, sc_body b, sc_point centre, double angle);
/// Velocity of the centre of mass (m/s) and spin (rad/s); wakes it.
SC_API sc_status sc_body_set_velocity(sc_world w, sc_body b, sc_point velocity, double spin);
/// Impulse (N s) at a point (m); wakes it. Dynamic bodies only.
SC_API sc_status sc_body_apply_impulse(sc_world w, sc_body b, sc_point impulse, sc_point at);
/// Outline of one fixture, 0 for the oldest, as a polygon in the world, m; a chain is open. Circles have 32 points.
SC_API int32_t sc_body_outline(sc_world w, sc_body b, int32_t fixture, sc_point* out, int32_t capacity);
/// Number of fixtures.
SC_API int32_t sc_body_fixtures(sc_world w, sc_body b);
SC_API sc_status sc_body_set_friction_material(sc_world w, sc_body b, uint32_t material);
/// A conveyor: speed (m/s) of the surface of a fixture, or of all (-1).
SC_API sc_status sc_body_set_surface_speed(sc_world w, sc_body b, int32_t fixture, double speed);
SC_API sc_status sc_body_destroy(sc_world w, sc_body b);

/* ---- testing machine: its crosshead carries kinematic bodies and holds with SC_BASE_MOVING */

SC_API sc_status sc_crosshead_attach(sc_world w, const char* body);
/// Velocity, m/s.
SC_API sc_status sc_crosshead_set_velocity(sc_world w, sc_point velocity);
/// Force of the shells on it in the last step, N.
SC_API sc_status sc_crosshead_force(sc_world w, sc_point* out);

/* ---- queries: `mask` selects shells by a common bit with their category */

/// Every point where the ray enters a shell, in the order along the ray.
SC_API int32_t sc_ray_cast(sc_world w, sc_point from, sc_point to, uint32_t mask, sc_hit* out, int32_t capacity);
/// The surface point closest to a point: of one shell, or (null) of any within `max_distance` (m, may be infinite).
/// SC_REFUSED: there is none.
SC_API sc_status sc_closest_point(sc_world w, sc_shell only, sc_point to, double max_distance, uint32_t mask,
                                  sc_hit* out);
SC_API int32_t sc_overlap_point(sc_world w, sc_point at, uint32_t mask, sc_shell* out, int32_t capacity);
SC_API int32_t sc_overlap_box(sc_world w, sc_point lower, sc_point upper, uint32_t mask, sc_shell* out,
                              int32_t capacity);
SC_API int32_t sc_overlap_circle(sc_world w, sc_point centre, double radius, uint32_t mask, sc_shell* out,
                                 int32_t capacity);

/* ---- zones and events of the last step */

/// A box whose shells are watched: SC_ZONE_ENTER and SC_ZONE_LEAVE at the end of a step. Zones are not saved.
SC_API sc_status sc_zone_create(sc_world w, sc_point lower, sc_point upper, sc_zone* out);
SC_API int32_t sc_zone_valid(sc_world w, sc_zone z);
/// The shells inside at the end of the last step.
SC_API int32_t sc_zone_shells(sc_world w, sc_zone z, sc_shell* out, int32_t capacity);
SC_API sc_status sc_zone_destroy(sc_world w, sc_zone z);
/// In the order of time.
SC_API int32_t sc_world_events(sc_world w, sc_event* out, int32_t capacity);
SC_API sc_status sc_world_set_event_settings(sc_world w, const sc_event_settings* to);
SC_API sc_status sc_world_event_settings(sc_world w, sc_event_settings* out);

/* ---- state and log: bytes that travel between machines */

/// The state of shells and bodies. Shells go on bitwise; Box2D forgets the warm start of dynamic bodies.
SC_API int32_t sc_world_save(sc_world w, uint8_t* out, int32_t capacity);
/// Back to a state of a world with the same bodies; those made since then stay. Handles of shells are valid again if
/// the state is one of the last sixteen that this world saved, else all of them are stale and sc_world_shells lists new
/// ones.
SC_API sc_status sc_world_restore(sc_world w, const uint8_t* bytes, int32_t count);
/// Records every call that changes shells; calls that change bodies are not recorded. `seed` is your own.
SC_API sc_status sc_log_start(sc_world w, uint64_t seed);
/// The calls since sc_log_start. Goes on recording.
SC_API int32_t sc_log_read(sc_world w, uint8_t* out, int32_t capacity);
SC_API sc_status sc_log_stop(sc_world w);
/// Repeats the calls of a log in a world with the bodies of its start.
SC_API sc_status sc_log_replay(sc_world w, const uint8_t* bytes, int32_t count);

/* ---- scenes: JSON text in, all problems out (docs/reference/scene_format.md) */

/// Problems as JSON: [{"line", "column", "pointer", "what", "expected", "nearest", "note", "text"}]; "[]": valid, no
/// notes. `file` names the text in messages and may be null. Needs no world.
SC_API const char* sc_scene_check(const char* json, int32_t bytes, const char* file);
/// Gravity and Box2D units that the scene wants, into a definition of sc_world_def_init.
SC_API sc_status sc_scene_world_def(const char* json, int32_t bytes, sc_world_def* def);
/// Creates its bodies, joints, shells and holds; `parameters` is null or {"name": number}. `seed` is of its random
/// drop. All problems stand in sc_error(), one a line.
SC_API sc_status sc_scene_load(sc_world w, const char* json, int32_t bytes, const char* file, const char* parameters,
                               uint64_t seed, sc_scene* out);
SC_API int32_t sc_scene_valid(sc_scene s);
/// Advances the scene and its world by at most dt (s).
SC_API sc_status sc_scene_step(sc_scene s, double dt, sc_frame* out);
/// 1: the end of its protocol or duration, or a failure.
SC_API int32_t sc_scene_finished(sc_scene s);
/// "drop 7", "settle", "approach", "load 1", "unload 1", "hold", "free", "done".
SC_API const char* sc_scene_phase(sc_scene s);
SC_API const char* sc_scene_name(sc_scene s);
/// Parameters as JSON: [{"name", "value", "min", "max", "unit", "about"}].
SC_API const char* sc_scene_parameters(sc_scene s);
/// Its shells, in the order of creation.
SC_API int32_t sc_scene_shells(sc_scene s, sc_shell* out, int32_t capacity);
/// Of the crosshead along its direction, m.
SC_API double sc_scene_travel(sc_scene s);
/// On the crosshead, N; positive while the specimen resists.
SC_API double sc_scene_force(sc_scene s);
/// Ends the scene; its bodies and shells stay.
SC_API sc_status sc_scene_destroy(sc_scene s);

/* ---- picture: one draw list for pages, windows and files (docs/reference/picture.md) */

/// 800 x 600 px, everything fits, all layers.
SC_API void sc_view_init(sc_view* view);
/// Makes the draw list of the world. The three calls below give its parts, which stay good until the world's next
/// sc_picture_make.
SC_API sc_status sc_picture_make(sc_world w, const sc_view* view);
/// Two an operation: its code and how many numbers it has. `count` is set to the number of all.
SC_API const int32_t* sc_picture_operations(sc_world w, int32_t* count);
/// The numbers of all operations, one after the other.
SC_API const float* sc_picture_numbers(sc_world w, int32_t* count);
/// The texts of all text operations, each ended by a zero; `bytes` is set to the number with the zeros.
SC_API const char* sc_picture_texts(sc_world w, int32_t* bytes);
/// The world as an SVG element.
SC_API const char* sc_picture_svg(sc_world w, const sc_view* view);

/* ---- sound: snaps, hits and slides as samples, mono, 48000 a second, between -1 and 1 */

/// Makes the samples that follow the last ones: `seconds` (0 to 10) of sound, in which is heard what the steps since
/// the last call did. The first call switches the sound of the world on.
SC_API sc_status sc_sound_make(sc_world w, double seconds);
/// They stay good until the world's next sc_sound_make. `count` is set to their number.
SC_API const float* sc_sound_samples(sc_world w, int32_t* count);
/// Samples as a WAV file (mono, 48000 a second, 32-bit floats).
SC_API int32_t sc_sound_wav(const float* samples, int32_t count, uint8_t* out, int32_t capacity);

#endif
