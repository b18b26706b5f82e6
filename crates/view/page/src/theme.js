// Light or dark: as the system has it, until somebody chooses.

const CHOICES = /** @type {const} */ (["light", "dark"]);

export class Theme {
  /** @param {() => void} changed */
  constructor(changed) {
    this.changed = changed;
    this.system = matchMedia("(prefers-color-scheme: dark)");
    this.system.addEventListener("change", () => this.apply());
  }

  apply() {
    this.set(remembered() ?? (this.system.matches ? "dark" : "light"));
  }

  /** The other one. */
  next() {
    const theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    try {
      localStorage.setItem("theme", theme);
    } catch {
      // A page without storage forgets the choice.
    }
    this.set(theme);
  }

  /** @param {typeof CHOICES[number]} theme */
  set(theme) {
    document.documentElement.dataset.theme = theme;
    this.changed();
  }
}

/** What was chosen, if anything was. */
function remembered() {
  try {
    const held = localStorage.getItem("theme");
    return CHOICES.find((theme) => theme === held);
  } catch {
    return undefined;
  }
}
