//! Prints a page to a PDF by an installed browser.

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// File name of the report as PDF.
pub const NAME: &str = "report.pdf";

/// Names of the browsers that print without a window, in the order in which they are tried.
const BROWSERS: &str = "chromium chromium-browser google-chrome google-chrome-stable chrome microsoft-edge \
                        microsoft-edge-stable msedge";

/// Paths of browsers that are installed outside the search path.
const PLACES: [&str; 5] = [
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
    r"C:\Program Files (x86)\Microsoft\Edge\Application\msedge.exe",
];

/// Longest time for a print: a report of megabytes takes some seconds; a browser that takes longer hangs.
const LONGEST: Duration = Duration::from_mins(1);

/// Prints a page; the error is a sentence that says why there is no PDF.
pub fn print_page(page: &[u8]) -> Result<Vec<u8>, String> {
    let browser = find_browser().ok_or("no Chromium, Chrome or Edge was found")?;
    let name = browser.display().to_string();
    let explain = |what: &dyn std::fmt::Display| format!("{name} did not print it: {what}");
    let folder = tempfile::Builder::new().prefix("dropcheck-pdf-").tempdir().map_err(|e| explain(&e))?;
    let [html, pdf] = ["report.html", NAME].map(|name| folder.path().join(name));
    std::fs::write(&html, page).map_err(|e| explain(&e))?;
    let mut command = Command::new(&browser);
    // Chromium refuses to run as root without this option, which is for trusted pages: this one is our own
    // and runs no script.
    #[cfg(unix)]
    if rustix::process::geteuid().is_root() {
        command.arg("--no-sandbox");
    }
    let child = command
        .args(["--headless", "--disable-gpu", "--no-first-run", "--no-pdf-header-footer"])
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("--print-to-pdf={}", pdf.display()))
        .arg(&html)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|e| explain(&e))?;
    wait_for(child).map_err(|e| explain(&e))?;
    std::fs::read(&pdf).map_err(|e| explain(&e))
}

fn find_browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let on_path = std::env::split_paths(&path).flat_map(|folder| {
        BROWSERS.split(' ').map(move |name| folder.join(name).with_extension(std::env::consts::EXE_EXTENSION))
    });
    on_path.chain(PLACES.map(PathBuf::from)).find(|browser| browser.is_file())
}

fn wait_for(mut child: Child) -> std::io::Result<()> {
    let begun = Instant::now();
    while child.try_wait()?.is_none() {
        if begun.elapsed() > LONGEST {
            child.kill()?;
            child.wait()?;
            return Err(std::io::Error::other("it did not end within a minute"));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    Ok(())
}
