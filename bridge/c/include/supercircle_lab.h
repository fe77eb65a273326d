/* supercircle_lab.h: the laboratory from C: runs, sweeps, imports, replays, diagnoses. Library: libsupercircle_lab_c.
 *
 * A request is a JSON text, the answer is one. Both are described call by call in docs/reference/lab_requests.md. Null
 * is an answer for a request that is refused: sc_lab_error() says why, and sc_lab_status() is a status of
 * supercircle.h. An answer stays good until the same thread has got four more. Calls of different threads do not
 * disturb each other.
 *
 * Work goes on in a thread of its own. `progress`, if not null, is called about ten times a second in the caller's
 * thread with a number from 0 to 1 and a word about the stage. A result other than 0 cancels: the answer then has
 * "status": "cancelled" and what was done until then.
 */
#ifndef SUPERCIRCLE_LAB_H
#define SUPERCIRCLE_LAB_H

#include "supercircle.h"

typedef int32_t (*sc_lab_progress)(void* context, double fraction, const char* stage);

/* ---- laboratory */

/// SC_API_VERSION of the library.
SC_API int32_t sc_lab_api_version(void);
/// Why this thread's last request was refused: one sentence, or one line a problem. Empty if it was not.
SC_API const char* sc_lab_error(void);
/// Its status: SC_OK, SC_BAD_INPUT, SC_FAILED or SC_NO_MEMORY.
SC_API sc_status sc_lab_status(void);
/// Runs a scene: series, summary, events, pictures, motion.
SC_API const char* sc_lab_run(const char* request, sc_lab_progress progress, void* context);
/// Runs a scene for sets of parameters and seeds.
SC_API const char* sc_lab_sweep(const char* request, sc_lab_progress progress, void* context);
/// Reads exports of testing machines as an experiment.
SC_API const char* sc_lab_import(const char* request, sc_lab_progress progress, void* context);
/// Simulates a recorded experiment and compares.
SC_API const char* sc_lab_replay(const char* request, sc_lab_progress progress, void* context);
/// Finds what physics a simulation of a recorded experiment leaves out.
SC_API const char* sc_lab_diagnose(const char* request, sc_lab_progress progress, void* context);
/// Checks a scene, a sweep or an experiment.
SC_API const char* sc_lab_check(const char* request, sc_lab_progress progress, void* context);

#endif
