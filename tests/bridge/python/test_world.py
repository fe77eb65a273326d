"""Worlds: free fall, statics and conservation by closed forms, handles, errors, copies."""

import gc
import threading

import numpy as np
import pytest

import supercircle as sc

GROUND = {"body": [{"name": "ground", "type": 0, "fixture": [{"polygon": {"vertices": {"x": [-1, 1, 1, -1], "y": [-0.1, -0.1, 0, 0]}}}]}]}


def test_a_shell_falls_as_galilei_says():
    with sc.World() as world:
        shell = world.create_shell("one", position=(0.0, 1.0))
        start = shell.state.centre
        for _ in range(30):
            frame = world.step(1.0 / 60.0)
        # midpoint steps are exact for a constant acceleration; Box2D rounds gravity to a float, 6e-8 at most
        assert shell.state.centre[1] - start[1] == pytest.approx(-0.5 * 9.81 * 0.5**2, rel=6e-8)
        assert frame.advanced == pytest.approx(1.0 / 60.0)
        assert world.time == pytest.approx(0.5)
        assert abs(world.energy.residual) < 1e-12


def test_a_hold_carries_the_weight():
    with sc.World() as world:
        shell = world.create_shell(damping_ratio=1.0)
        with shell.hold(0.5, "clamp") as hold:
            for _ in range(60):
                world.step()
            weight = shell.state.mass * 9.81
            # oscillations decay with critical damping: a thousandth of the weight is left at most
            assert hold.reaction.force == pytest.approx([0.0, weight], abs=1e-3 * weight)
        assert not hold.valid
        with pytest.raises(sc.StaleError):
            hold.reaction


def test_shapes_are_equally_spaced_copies():
    with sc.World() as world:
        assert world.shapes(8).shape == (0, 8, 2)
        first = world.create_shell(position=(0, 0))
        world.create_shell(position=(1, 0), elements=31)
        shapes = world.shapes(33)
        assert shapes.shape == (2, 33, 2) and shapes.dtype == np.float64
        # chords of equal arcs of a circle: 2 R sin(L / (64 R)); the polyline deviates by 1e-5 L at most
        chord = 2 * 0.0192 * np.sin(first.state.length / 64 / 0.0192)
        assert np.hypot(*np.diff(shapes[0], axis=0).T) == pytest.approx(np.full(32, chord), rel=1e-4)
        shapes[:] = 0.0
        assert first.polyline()[0] != pytest.approx([0, 0])
        assert first.curvatures() == pytest.approx(np.full(15, 1 / 0.0192))
        assert first.section(0.5).position == pytest.approx([0, 0], abs=1e-12)


def test_bodies_joints_queries_zones_and_events():
    with sc.World(units_per_metre=50) as world:
        world.add(GROUND)
        shell = world.create_shell("bow", position=(0, 0.001), velocity=(0, -0.5))
        assert world.find_shell("bow") == shell and world.shells() == [shell]
        zone = world.create_zone((-1, -1), (1, 1))
        kinds = set()
        for _ in range(20):
            world.step()
            kinds |= {event.kind for event in world.events()}
        assert {"contact_begin", "zone_enter"} <= kinds
        assert zone.shells == [shell]
        ground = world.find_body("ground")
        assert ground.outlines()[0].shape == (4, 2) and ground.state.mass == 0
        hits = world.ray_cast((0, 1), (0, -1))
        assert hits[0].shell == shell and hits[0].normal == pytest.approx([0, 1], abs=0.2)
        assert world.closest_point((0, 1)).distance > 0.9
        assert world.overlap_box((-1, -1), (1, 1)) == [shell] and world.overlap_point((5, 5)) == []
        tether = shell.join(kind="tether", arc=0.0, point=(0, 0.2))
        tether.set_max_length(0.05, 1.0)
        for _ in range(30):
            world.step()
        assert tether.reaction.force[1] > 0 and tether.length == pytest.approx(0.05, rel=1e-3)


def test_bodies_by_definition_and_shells_of_any_size():
    with sc.World() as world:
        world.create_body("ground", type="static", line=[(-20, 0), (20, 0)])
        crate = world.create_body("crate", box=(0.6, 0.4), density=2, position=(5, 1))
        ball = world.create_body(circle=0.5, position=(-5, 2), velocity=(0, -1))
        wedge = world.create_body(polygon=np.array([[0, 0], [1, 0], [0, 1]]), position=(8, 1), fixed_rotation=True)
        assert [b.state.mass for b in (crate, ball, wedge)] == pytest.approx([0.48, np.pi / 4, 0.5], rel=1e-6)  # floats of Box2D
        assert world.find_body("crate") == crate and len(world.bodies()) == 4
        shell = world.create_shell(**sc.scaled_shell(1.0, 2.0, opening=0.5, stiffness=2), position=(0, 2))
        assert shell.state.mass == pytest.approx(2)
        for _ in range(120):
            world.step()
        assert [b.state.centre[1] for b in (crate, ball)] == pytest.approx([0.2, 0.5], abs=0.0151)  # Box2D's skin and slop, 10 and 5 mm
        for given, words in [({}, "none of them"), (dict(box=(1, 1), circle=1), "box and circle"), (dict(box=(1, 0)), "height"),
                             (dict(circle=-1), "radius"), (dict(circle="big"), "radius"), (dict(polygon=[(0, 0), (1, 0)]), "3 to 8"),
                             (dict(polygon=[1, 2, 3]), "shape"), (dict(line=[(0, 0), (1, 0)]), "static"),
                             (dict(circle=1, frction=1), "did you mean friction"), (dict(circle=1, type="fixed"), "kinematic"),
                             (dict(circle=0.0005), "units_per_metre")]:
            with pytest.raises(sc.BadInputError, match=words):
                world.create_body(**given)
        assert len(world.bodies()) == 4
        with pytest.raises(sc.BadInputError, match="radius"):
            sc.scaled_shell(0, 1)


def test_saved_worlds_and_logs_repeat_to_the_bit():
    with sc.World() as world, sc.World() as other:
        shell = world.create_shell()
        shell.hold(0.5)
        state = world.save()
        world.start_log(3)
        for _ in range(10):
            world.step()
        log, end = world.read_log(), world.hash
        world.restore(state)
        assert shell.valid and world.hash != end
        for _ in range(10):
            world.step()
        assert world.hash == end
        other.replay_log(log)
        assert other.hash == end


def test_a_scene_is_played():
    with sc.World.for_scene("two_shells") as world, world.load("two_shells", mu=0.2, travel_over_R=0.05) as scene:
        assert scene.parameters[1]["value"] == 0.2 and len(scene.shells) == 2
        largest = 0.0
        while not scene.finished:
            scene.step(0.02)
            largest = max(largest, scene.force)
        assert scene.phase == "done" and largest > 0.0
        assert world.svg(200, 100).startswith("<svg") and "<svg" in world._repr_html_()


def test_pictures_and_sound():
    with sc.World.for_scene("two_shells") as world, world.load("two_shells", phi_bar=0.9, mu=0.1) as scene:
        heard = [world.sound(0.0)]
        assert heard[0].shape == (0,) and heard[0].dtype == np.float32
        while world.time < 4.1:  # it snaps at 3.9 s
            scene.step(1 / 60)
            heard.append(world.sound(1 / 60))
        assert all(h.size == 800 for h in heard[1:]) and 0.05 < np.abs(np.concatenate(heard)).max() < 1.0
        picture = world.picture(320, 240, clock=1.0)
        assert picture.operations[:, 1].sum() == picture.numbers.size and np.isfinite(picture.numbers).all()
        assert "19 mJ" in picture.texts and (picture.operations[:, 0] == 4).sum() == 1  # and a flash
        still = world.picture(320, 240, clock=1.1, reduced_motion=True)
        assert "19 mJ" in still.texts and (still.operations[:, 0] == 4).sum() == 0
        assert world.picture(320, 240, layers="bodies").texts == []
        file = sc.wav(heard[-1])
        assert file[:4] == b"RIFF" and file[58:] == heard[-1].tobytes()
        with pytest.raises(sc.BadInputError, match="pixel_ratio"):
            world.picture(pixel_ratio=0)


def test_effects_and_materials():
    with sc.World() as world:
        shell = world.create_shell()
        shell.set_effect("planar_drag", f_N_m=0.2)
        assert shell.effects[0]["key"] == "planar_drag"
        world.remove_effect("planar_drag")
        assert shell.effects == []
        mass = shell.state.mass
        shell.set_material(density=2 * 1270)
        assert shell.state.mass == pytest.approx(2 * mass)
        assert "planar_drag" in {e["key"] for e in sc.effects()}


def test_refusals_have_a_class_and_a_sentence():
    with sc.World() as world:
        shell = world.create_shell()
        for call, kind, words in [
            (lambda: sc.World(gravity=(0, float("nan"))), sc.BadInputError, "finite"),
            (lambda: sc.World(gravity=3), sc.BadInputError, "two numbers"),
            (lambda: sc.World(quality="best"), sc.BadInputError, "laboratory, game"),
            (lambda: world.create_shell(radus=1), sc.BadInputError, "radius"),
            (lambda: world.create_shell(radius="big"), sc.BadInputError, "radius"),
            (lambda: world.find_shell("nobody"), sc.Error, "nobody"),
            (lambda: world.load("two_shels"), sc.BadInputError, "two_shells"),
            (lambda: world.load("two_shells", mew=1), sc.BadInputError, "mew"),
            (lambda: world.load({"shel": []}), sc.BadInputError, "shell"),
            (lambda: world.load("{nonsense"), sc.BadInputError, ""),
            (lambda: world.add("{"), sc.BadInputError, ""),
            (lambda: shell.section(2.0), sc.BadInputError, "between 0 and 1"),
            (lambda: shell.set_natural_curvature([1, 2]), sc.BadInputError, ""),
            (lambda: world.overlap_point((0, float("inf"))), sc.BadInputError, ""),
            (lambda: world.step(float("nan")), sc.BadInputError, ""),
        ]:
            with pytest.raises(kind, match=words) as caught:
                call()
            assert str(caught.value)
        shell.destroy()
        with pytest.raises(sc.StaleError):
            shell.state
    with pytest.raises(sc.Error):
        world.step()
    with pytest.raises(sc.StaleError):
        shell.state
    assert issubclass(sc.BadInputError, ValueError)


def test_a_scene_is_checked_without_a_world():
    assert sc.check_scene("two_shells") == []
    problem = sc.check_scene({"schema": "supercircle-scene/1", "shel": []})[0]
    assert problem.pointer == "/shel" and problem.nearest == "shell" and problem.line > 0 and problem.text


def test_forgotten_worlds_end():
    for _ in range(5000):  # 4095 worlds exist at most
        sc.World()
    gc.collect()


def test_a_second_thread_in_a_world_is_refused_and_others_are_not():
    with sc.World() as world:
        for k in range(12):
            world.create_shell(position=(0.0, 0.05 * k))
        stop, seen = threading.Event(), set()

        def look():
            while not stop.is_set():
                try:
                    world.time
                except sc.Error as error:
                    seen.add(str(error))
                with sc.World() as own:
                    own.step()

        thread = threading.Thread(target=look)
        thread.start()
        done = 0
        while done < 30:
            try:
                world.step()
                done += 1
            except sc.BusyError:
                pass
        stop.set()
        thread.join()
        assert all("thread" in text for text in seen)
