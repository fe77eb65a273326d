// Six small goals; what was reached stays ticked in this browser.

const goalTexts = {
  snap: "snap one", stick: "make it stick", nest: "nest three", five: "five snaps in one press", joules: "300 J in one press",
  hold: "hold 10 N in the first fifth of the way",
};

class Goals {
  constructor(list, say) {
    this.list = list;
    this.say = say;
    this.done = new Set();
    try {
      this.done = new Set(JSON.parse(localStorage.getItem("supercircle-goals") ?? "[]"));
    } catch { /* storage may be refused */ }
    this.begin();
    for (const [key, text] of Object.entries(goalTexts)) {
      const item = document.createElement("li");
      item.textContent = text;
      item.id = `goal-${key}`;
      item.classList.toggle("done", this.done.has(key));
      list.append(item);
    }
  }

  /** Shows those that a scene has. */
  show(keys) {
    for (const key in goalTexts)
      document.getElementById(`goal-${key}`).hidden = !keys.includes(key);
    this.list.hidden = keys.length === 0;
  }

  /** A new stroke of the press. */
  begin() {
    this.snaps = 0;
    this.joules = 0;
    this.held = 0;
  }

  reach(key) {
    if (this.done.has(key))
      return;
    this.done.add(key);
    document.getElementById(`goal-${key}`).classList.add("done");
    this.say(`Goal reached: ${goalTexts[key]}`);
    try {
      localStorage.setItem("supercircle-goals", JSON.stringify([...this.done]));
    } catch { /* storage may be refused */ }
  }

  /** What a frame of `dt` seconds shows; `unit`: B / R^2 in N, `most`: the largest travel in m. */
  see(frame, dt, { unit, most, byHand }) {
    for (const snap of frame.snaps) {
      ++this.snaps;
      this.joules += snap.energy;
    }
    if (!byHand)
      return;
    if (frame.snaps.length > 0)
      this.reach("snap");
    if (this.snaps >= 5)
      this.reach("five");
    if (this.joules >= 300)
      this.reach("joules");
    if (frame.nested >= 3)
      this.reach("nest");
    if (unit && frame.force > unit)
      this.reach("stick");
    this.held = most && frame.force >= 10 && frame.travel > 0 && frame.travel < 0.2 * most ? this.held + dt : 0;
    if (this.held >= 1)
      this.reach("hold");
  }
}
