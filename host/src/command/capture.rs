//! `breakaway capture`.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use breakaway_core::link::{Command, Event, Message};
use schemars::JsonSchema;
use serde::Serialize;

use super::console;
use super::output::Output;
use super::port_args::{self, MonitorArgs, PortArgs};
use super::progress;
use super::recording_args::positive;
use crate::device::capture::{Capture, part_of};
use crate::device::scale::Scale;
use crate::device::{Client, DeviceError, text, wait_for};
use crate::file::FileKind;
use crate::interrupt::{FinishFirst, finish_first};

/// Longest silence of a board that streams.
const SILENCE: Duration = Duration::from_secs(3);
/// How often the progress line changes.
const REDRAW: Duration = Duration::from_millis(200);
/// How long one look for samples lasts.
const POLL: Duration = Duration::from_millis(50);

/// Record what a board measures, until Ctrl-C
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway capture --port /dev/ttyACM0 -o recording.csv
  breakaway capture --port /dev/ttyACM0 --seconds 10 --decimation 10 -o recording.csv
  breakaway capture --port /dev/ttyACM0 --seconds 10 -o recording.mcap

Ctrl-C ends the capture and closes the file properly. Until then the samples are in REC.csv.part, which is a valid
recording at every moment. Lost samples are counted and never filled in. The header's `gaps` names
the rows before which samples are missing, and the estimators cut the recording there. A name that ends in .mcap or
.parquet gives such a file at the end, for PlotJuggler, Foxglove or pandas. Its columns are named with their units.

`breakaway monitor` in another terminal watches, and --monitor in this one. `breakaway device stop` stops what is running.

If the board is unplugged, REC.csv has the samples until then, and the exit code is 1. With --wait the command waits
for the port to appear before it starts.

JSON: recording, samples, seconds, rate_hz, missing, gaps, dropped_on_board, lost_frames, damaged_frames, ended.")]
pub struct Args {
    /// The board.
    #[command(flatten)]
    pub port: PortArgs,
    /// The recording to write
    #[arg(short, long, value_name = "REC.csv")]
    pub output: PathBuf,
    /// Record every n-th sample
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub decimation: u16,
    /// End after this time of the board's clock, s
    #[arg(long, value_name = "S", value_parser = positive)]
    pub seconds: Option<f64>,
    /// Wait for the port to appear
    #[arg(long, requires = "port")]
    pub wait: bool,
    /// The monitor beside it.
    #[command(flatten)]
    pub monitor: MonitorArgs,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    recording: String,
    samples: u64,
    seconds: f64,
    rate_hz: f64,
    missing: u64,
    gaps: u64,
    dropped_on_board: u64,
    lost_frames: u64,
    damaged_frames: u64,
    ended: String,
}

impl Args {
    /// Captures until Ctrl-C, the time is up, or the board is gone.
    ///
    /// # Errors
    /// The board cannot be reached or is lost, the file cannot be written. What was captured until then is in the file.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        // It is written bit by bit beside its place.
        let file = output.folder(&self.output, "a file")?;
        output.may_write(file, FileKind::Recording, &[])?;
        let interrupt = finish_first();
        self.monitor.check(Some("the port"))?;
        if let Some(port) = self.port.port.as_ref().filter(|_| self.wait) {
            let spinner = progress::spinner();
            spinner.set_message(format!("waiting for {port}"));
            let there = wait_for(port, || !interrupt.requested());
            spinner.finish_and_clear();
            if !there {
                return Err(DeviceError::Interrupted.into());
            }
        }
        let port = &self.port.resolve()?;
        let (mut client, info) = Client::connect_alone(port, self.port.baud)?;
        port_args::shared(client.offer(), port);
        let scale = Scale::new(&info)?;
        let mut capture = Capture::create(&self.output, &info, scale, self.decimation, self.seconds)?;
        let damaged_before = client.counters().bad_frames();
        let screen = self.monitor.open(port, self.port.baud)?;
        let ended = self.receive(&mut client, &mut capture, &interrupt);
        drop(screen);
        if !matches!(ended, Err(DeviceError::Unplugged { .. })) {
            // The recording is what counts; a board that cannot be told goes on streaming, which harms nothing.
            let _ = client.done(Command::StreamOff);
        }
        let (totals, seconds) = (capture.totals(), capture.seconds());
        let reason = match &ended {
            Ok(reason) => (*reason).to_owned(),
            Err(error) => error.to_string(),
        };
        let kept = capture
            .finish(&reason)
            .map_err(|error| anyhow::anyhow!("{error}; the samples are in {}", part_of(&self.output).display()))?;
        let file = self.output.display();
        if let Err(error) = ended {
            let saved = if kept {
                format!("the {} samples until then ({seconds:.3} s) are in {file}", totals.samples)
            } else {
                "no sample had come, and no file was written".to_owned()
            };
            return Err(anyhow::anyhow!("{error}; {saved}"));
        }
        if !kept {
            return Err(anyhow::anyhow!("no sample had come, and {file} was not written"));
        }
        let document = Document {
            recording: self.output.display().to_string(),
            samples: totals.samples,
            seconds,
            rate_hz: f64::from(info.tick_hz) / f64::from(self.decimation),
            missing: totals.missing,
            gaps: totals.gaps,
            dropped_on_board: totals.dropped,
            lost_frames: totals.lost_batches,
            damaged_frames: client.counters().bad_frames() - damaged_before,
            ended: reason,
        };
        output.print(&document, summary)
    }

    /// Receives until there is a reason to end.
    fn receive(
        &self,
        client: &mut Client,
        capture: &mut Capture,
        interrupt: &FinishFirst,
    ) -> Result<&'static str, DeviceError> {
        client.done(Command::StreamOn { decimation: self.decimation })?;
        let spinner = progress::spinner();
        let (mut silence, mut drawn) = (Duration::ZERO, (Instant::now(), 0));
        loop {
            let turn = Instant::now();
            if interrupt.requested() {
                return Ok("Ctrl-C");
            }
            match client.receive(POLL)? {
                Some(Message::Samples(batch)) => {
                    if !capture.push(&batch, client.port())? {
                        return Ok("time up");
                    }
                    silence = Duration::ZERO;
                }
                Some(Message::Event(Event::Started)) => {
                    return Err(DeviceError::Restarted { port: client.port().to_owned() });
                }
                Some(Message::Event(Event::FaultRaised(fault))) => {
                    // Beside the monitor, which shows it, nothing is written.
                    let text = format!("the board reports a fault: {}", text::fault(&fault));
                    spinner.suspend(|| console::note(text));
                }
                _ if silence > SILENCE => {
                    return Err(DeviceError::Silent {
                        port: client.port().to_owned(),
                        command: "stream on",
                        seconds: SILENCE.as_secs_f64(),
                    });
                }
                // Time in which this process was suspended says nothing about the board.
                _ => silence += turn.elapsed().min(2 * POLL),
            }
            let (since, before) = (drawn.0.elapsed(), drawn.1);
            if since > REDRAW {
                let totals = capture.totals();
                let rate = (totals.samples - before) as f64 / since.as_secs_f64();
                drawn = (Instant::now(), totals.samples);
                spinner.set_message(format!(
                    "{} samples, {rate:.0}/s, {} missing ({} dropped on the board, {} frames lost), Ctrl-C ends",
                    totals.samples, totals.missing, totals.dropped, totals.lost_batches
                ));
            }
        }
    }
}

fn summary(document: &Document) -> String {
    let Document { recording, samples, seconds, rate_hz, missing, gaps, dropped_on_board, lost_frames, .. } = document;
    let lost = if *missing == 0 {
        "none missing".to_owned()
    } else {
        format!(
            "{missing} missing in {gaps} gaps ({dropped_on_board} dropped on the board, {lost_frames} frames lost): use a \
             larger --decimation or a faster link"
        )
    };
    format!("{samples} samples, {seconds:.3} s at {rate_hz} Hz, written to {recording}; {lost}")
}
