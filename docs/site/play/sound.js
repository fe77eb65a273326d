// Plays the samples of the library; starts with the first gesture, mute is remembered.

const RATE = 48000;

class Sound {
  constructor(button) {
    this.button = button;
    this.on = false;
    try {
      this.on = localStorage.getItem("supercircle-sound") === "on";
    } catch { /* storage may be refused */ }
    this.show();
    button.addEventListener("click", () => {
      this.on = !this.on;
      try {
        localStorage.setItem("supercircle-sound", this.on ? "on" : "off");
      } catch { /* storage may be refused */ }
      this.show();
      this.wake();
    });
  }

  show() {
    this.button.setAttribute("aria-pressed", String(this.on));
  }

  /** Browsers allow sound after a gesture only. */
  wake() {
    if (!this.on || this.context)
      return;
    try {
      this.context = new AudioContext({ sampleRate: RATE });
      this.until = 0;
    } catch {
      this.on = false;
      this.show();
    }
  }

  play(samples) {
    if (!this.on || !this.context || samples.length === 0)
      return;
    const buffer = this.context.createBuffer(1, samples.length, RATE);
    buffer.copyToChannel(samples, 0);
    const source = this.context.createBufferSource();
    source.buffer = buffer;
    source.connect(this.context.destination);
    const now = this.context.currentTime;
    if (this.until < now || this.until > now + 0.25)
      this.until = now + 0.05;
    source.start(this.until);
    this.until += samples.length / RATE;
  }
}
