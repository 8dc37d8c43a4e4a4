//! Faults of the machine, injected on the plant's side.

use std::str::FromStr;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The encoder stays where it is.
    EncoderFrozen,
    /// One channel of the encoder is dead: the count toggles by one.
    EncoderChannelDead,
    /// The encoder counts the other way.
    EncoderReversed,
    /// The encoder is off by this many counts from now on.
    EncoderJump(i32),
    /// The encoder does not answer.
    EncoderDead,
    /// The next tick comes late by this many microseconds.
    TickLate(u32),
    /// The break input, with a number.
    Break(i32),
    /// The emergency stop is open.
    EmergencyStop,
    /// The supply is at this voltage, mV.
    Supply(i32),
    /// The board is reset; the plant goes on.
    Reset,
    /// This many bytes of noise reach the board from the host's side, at most [`MOST_GARBAGE`].
    Garbage(u16),
    /// The host is gone in mid-motion: nothing passes the cable any more, either way.
    HostGone,
    /// Of a million bytes on the cable this many are flipped, lost or have garbage before them, either way.
    LinkNoise(u32),
    /// Bits of the flash's file are flipped before the board starts; at tick 0 only.
    CorruptFlash,
    /// All of the above is over.
    Healed,
}

/// Most bytes of noise at once: what the pseudo-terminal takes without a reader.
pub const MOST_GARBAGE: u16 = 2048;

/// What can be injected, for messages and help.
pub const FAULTS: &str = "encoder-frozen, encoder-channel-dead, encoder-reversed, encoder-jump=COUNTS, encoder-dead, tick-late=US, \
                          break=NUMBER, emergency-stop, supply=MV, \
                          reset, garbage=BYTES (at most 2048), host-gone, link-noise=PPM (at most 100000), \
                          corrupt-flash (at tick 0), healed";

/// Most of a million bytes that noise may hit: beyond, hardly a frame is left.
pub const MOST_NOISE: u32 = 100_000;

impl Fault {
    /// Whether it acts on the cable, which is then a thread of its own.
    pub const fn on_the_cable(self) -> bool {
        matches!(self, Self::HostGone | Self::LinkNoise(_))
    }
}

/// A fault at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Injection {
    /// Ticks since the start.
    pub tick: u64,
    /// What.
    pub fault: Fault,
}

impl FromStr for Injection {
    type Err = String;

    /// `TICK:NAME` or `TICK:NAME=NUMBER`.
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected TICK:FAULT, FAULT one of {FAULTS}");
        let (tick, fault) = text.split_once(':').ok_or_else(wrong)?;
        let (name, number) = fault.split_once('=').unwrap_or((fault, ""));
        let signed = || number.parse::<i32>().map_err(|_| wrong());
        let tick = tick.parse().map_err(|_| wrong())?;
        let fault = match (name, number) {
            ("encoder-frozen", "") => Fault::EncoderFrozen,
            ("encoder-channel-dead", "") => Fault::EncoderChannelDead,
            ("encoder-reversed", "") => Fault::EncoderReversed,
            ("encoder-jump", _) => Fault::EncoderJump(signed()?),
            ("encoder-dead", "") => Fault::EncoderDead,
            ("tick-late", _) => Fault::TickLate(number.parse().map_err(|_| wrong())?),
            ("break", _) => Fault::Break(signed()?),
            ("emergency-stop", "") => Fault::EmergencyStop,
            ("supply", _) => Fault::Supply(signed()?),
            ("reset", "") => Fault::Reset,
            ("garbage", _) => Fault::Garbage(number.parse().ok().filter(|n| *n <= MOST_GARBAGE).ok_or_else(wrong)?),
            ("host-gone", "") => Fault::HostGone,
            ("link-noise", _) => Fault::LinkNoise(number.parse().ok().filter(|n| *n <= MOST_NOISE).ok_or_else(wrong)?),
            ("corrupt-flash", "") if tick == 0 => Fault::CorruptFlash,
            ("healed", "") => Fault::Healed,
            _ => return Err(wrong()),
        };
        Ok(Self { tick, fault })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn injections_are_read_or_refused() {
        let read = |text: &str| text.parse::<Injection>();
        assert_eq!(read("20:encoder-frozen"), Ok(Injection { tick: 20, fault: Fault::EncoderFrozen }));
        assert_eq!(read("0:encoder-jump=-9"), Ok(Injection { tick: 0, fault: Fault::EncoderJump(-9) }));
        assert_eq!(read("7:garbage=2048"), Ok(Injection { tick: 7, fault: Fault::Garbage(2048) }));
        assert_eq!(read("9:host-gone"), Ok(Injection { tick: 9, fault: Fault::HostGone }));
        assert_eq!(read("0:link-noise=100"), Ok(Injection { tick: 0, fault: Fault::LinkNoise(100) }));
        assert_eq!(read("0:corrupt-flash"), Ok(Injection { tick: 0, fault: Fault::CorruptFlash }));
        for wrong in [
            "1:corrupt-flash",
            "1:garbage=2049",
            "reset",
            "x:reset",
            "1:reset=2",
            "1:supply",
            "1:supply=low",
            "1:quake",
            "1:tick-late=-1",
            "1:host-gone=1",
            "1:link-noise",
            "1:link-noise=100001",
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
