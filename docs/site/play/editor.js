// The text of the scene, its problems at line and column, and the loader's suggestions as buttons.

class Editor {
  constructor(area, list, check) {
    this.area = area;
    this.list = list;
    let pending = 0;
    area.addEventListener("input", () => {
      clearTimeout(pending);
      pending = setTimeout(() => check(area.value), 300);
    });
  }

  offsetOf(line, column) {
    const lines = this.area.value.split("\n");
    let at = 0;
    for (let i = 0; i + 1 < line && i < lines.length; ++i)
      at += lines[i].length + 1;
    return Math.min(this.area.value.length, at + Math.max(0, column - 1));
  }

  /** Selects the word or string at a line and column, and scrolls there. */
  jump(line, column) {
    const from = this.offsetOf(line, column), rest = this.area.value.slice(from);
    const length = (/^"(?:[^"\\]|\\.)*"?|^[\w.+-]+/.exec(rest) ?? [" "])[0].length;
    this.area.focus();
    this.area.setSelectionRange(from, from + length);
    const height = this.area.scrollHeight / Math.max(1, this.area.value.split("\n").length);
    this.area.scrollTop = Math.max(0, (line - 4) * height);
    return [from, from + length];
  }

  show(problems) {
    this.list.replaceChildren();
    for (const p of problems) {
      const item = document.createElement("li"), jump = document.createElement("button");
      jump.type = "button";
      jump.textContent = p.text;
      jump.addEventListener("click", () => this.jump(p.line, p.column));
      item.append(jump);
      if (p.nearest) {
        const mend = document.createElement("button");
        mend.type = "button";
        mend.className = "mend";
        mend.textContent = `Write "${p.nearest}"`;
        mend.addEventListener("click", () => this.apply(p));
        item.append(mend);
      }
      this.list.append(item);
    }
  }

  apply(problem) {
    const [from, to] = this.jump(problem.line, problem.column);
    const quoted = this.area.value[from] === "\"";
    this.area.setRangeText(quoted ? JSON.stringify(problem.nearest) : problem.nearest, from, to, "end");
    this.area.dispatchEvent(new Event("input"));
  }
}
