/* The C interface as a stranger uses it, in C99 and (included by program.cpp) in C++17. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <supercircle.h>
#ifdef WITH_LAB
#include <supercircle_lab.h>
#endif

static const char* const floor_and_ball =
    "{\"schema\": \"supercircle-scene/1\", \"body\": ["
    "{\"name\": \"floor\", \"type\": 0, \"position\": {\"x\": 0, \"y\": -0.05}, \"fixture\": [{\"friction\": 0.5,"
    " \"polygon\": {\"vertices\": {\"x\": [-0.5, 0.5, 0.5, -0.5], \"y\": [0, 0, 0.05, 0.05]}}}]},"
    "{\"name\": \"ball\", \"type\": 2, \"position\": {\"x\": 0.1, \"y\": 0.1}, \"fixture\": [{\"density\": 1,"
    " \"circle\": {\"center\": {\"x\": 0, \"y\": 0}, \"radius\": 0.02}}]}]}";

/* Ends the program unless a call was done. */
static void done(sc_status status, const char* call) {
    if (status == SC_OK)
        return;
    fprintf(stderr, "%s: status %d: %s\n", call, (int)status, sc_error());
    exit(1);
}
#define DONE(call) done(call, #call)

static void expect(int holds, const char* what) {
    if (holds)
        return;
    fprintf(stderr, "not so: %s\n", what);
    exit(1);
}
#define EXPECT(condition) expect(condition, #condition)

int main(void) {
    sc_world world;
    sc_world_def world_def;
    sc_shell shell, same;
    sc_shell_def shell_def;
    sc_shell_state state;
    sc_body ball;
    sc_body_state ball_state;
    sc_frame frame;
    sc_event events[64];
    sc_point points[512];
    sc_view view;
    uint8_t* saved;
    uint64_t hash;
    int32_t size, i, touched = 0;
    double alarm = 0.0;

    EXPECT(sc_api_version() == SC_API_VERSION);
    sc_world_def_init(&world_def);
    world_def.units_per_metre = 52.1;
    DONE(sc_world_create(&world_def, &world));
    DONE(sc_world_add(world, floor_and_ball, -1));
    sc_shell_def_init(&shell_def);
    shell_def.position.y = 0.05;
    DONE(sc_shell_create(world, &shell_def, "one", NULL, 0, &shell));
    DONE(sc_world_find_shell(world, "one", &same));
    EXPECT(same.id == shell.id);
    for (i = 0; i < 120; ++i) {
        int32_t k, count;
        DONE(sc_world_step(world, 1.0 / 240.0, &frame));
        alarm = frame.energy_gained > alarm ? frame.energy_gained : alarm;
        count = sc_world_events(world, events, 64);
        for (k = 0; k < count; ++k)
            touched += events[k].kind == SC_CONTACT_BEGIN && events[k].a.id == shell.id;
    }
    EXPECT(touched > 0);
    EXPECT(alarm == 0.0);
    DONE(sc_shell_state_of(world, shell, &state));
    EXPECT(state.centre.y > 0.0 && state.centre.y < 0.03); /* it lies on the floor */
    DONE(sc_body_find(world, "ball", &ball));
    DONE(sc_body_state_of(world, ball, &ball_state));
    EXPECT(fabs(ball_state.centre.y - 0.02) < 0.002); /* so does the ball, within Box2D's slop */
    size = sc_shell_polyline(world, shell, 1e-5, points, 512);
    EXPECT(size > 15 && size < 512);
    EXPECT(sc_shell_polyline(world, shell, 1e-5, NULL, 0) == size);

    size = sc_world_save(world, NULL, 0);
    saved = (uint8_t*)sc_alloc(size);
    EXPECT(saved != NULL && sc_world_save(world, saved, size) == size);
    hash = sc_world_hash(world);
    DONE(sc_world_step(world, 1.0 / 240.0, NULL));
    EXPECT(sc_world_hash(world) != hash);
    DONE(sc_world_restore(world, saved, size));
    EXPECT(sc_world_hash(world) == hash && sc_shell_valid(world, shell));
    sc_free(saved);

    sc_view_init(&view);
    EXPECT(strstr(sc_picture_svg(world, &view), "<svg") != NULL);
    EXPECT(strcmp(sc_scene_check("{\"shell\": [{\"nam\": 1}]}", -1, NULL), "[]") != 0);
    shell_def.radius = NAN;
    EXPECT(sc_shell_create(world, &shell_def, NULL, NULL, 0, &same) == SC_BAD_INPUT && strlen(sc_error()) > 10);
    DONE(sc_shell_destroy(world, shell));
    EXPECT(sc_shell_state_of(world, shell, &state) == SC_STALE);
    DONE(sc_world_destroy(world));
    EXPECT(sc_world_step(world, 0.1, NULL) == SC_STALE);
#ifdef WITH_LAB
    EXPECT(sc_lab_api_version() == SC_API_VERSION);
    EXPECT(strstr(sc_lab_check("{\"scene\": {\"shell\": [{\"nam\": 1}]}}", NULL, NULL), "\"valid\":false") != NULL);
    EXPECT(sc_lab_run("{\"scen\": 1}", NULL, NULL) == NULL && sc_lab_status() == SC_BAD_INPUT);
#endif
    printf("version %s: %d contacts began\n", sc_version(), (int)touched);
    return 0;
}
