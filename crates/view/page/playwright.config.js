import { defineConfig } from "@playwright/test";

export default defineConfig({
  testDir: "tests",
  // Frame times and latencies are measured: nothing else may run beside them.
  workers: 1,
  timeout: 60_000,
  reporter: [["list"]],
  snapshotPathTemplate: "{testDir}/pictures/{arg}{ext}",
  expect: {
    // Fonts and their smoothing differ from machine to machine; a lost layer or a broken layout is far more than this.
    toHaveScreenshot: { maxDiffPixelRatio: 0.04, threshold: 0.25, animations: "disabled" },
  },
  use: {
    browserName: "chromium",
    viewport: { width: 1280, height: 800 },
    colorScheme: "light",
    locale: "en-GB",
    launchOptions: {
      executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
      args: ["--no-sandbox", "--force-color-profile=srgb", "--font-render-hinting=none"],
    },
  },
});
