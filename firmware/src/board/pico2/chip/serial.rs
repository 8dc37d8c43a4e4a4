//! The link as a serial port of USB (CDC-ACM), polled by the thread.
//!
//! The tick wakes the thread every 100 µs, and USB asks for 10 ms. So there is no interrupt of USB that could delay a
//! tick, and no executor. The locks of the HAL's driver mask interrupts while a packet is copied, some µs.

use cortex_m::singleton;
use rp235x_hal::rom_data::sys_info_api::chip_info;
use rp235x_hal::usb::UsbBus;
use usb_device::bus::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbVidPid};
use usbd_serial::{SerialPort, USB_CLASS_CDC};

use crate::board::Wire;
use crate::board::pico2::constants::{RECEIVE_BYTES, SEND_BYTES, SENT_POLLS, USB_ID};

type Port = SerialPort<'static, UsbBus, [u8; RECEIVE_BYTES], [u8; SEND_BYTES]>;

/// Hexadecimal digits of the chip's number.
const DIGITS: usize = 16;

/// The link's bytes.
pub struct Serial {
    device: UsbDevice<'static, UsbBus>,
    port: Port,
    /// Polls since nothing was left to be handed to the hardware.
    idle_polls: u32,
}

impl Serial {
    /// Appears on the bus; once.
    ///
    /// # Panics
    /// On a second call.
    pub(super) fn start(bus: UsbBus) -> Self {
        let (Some(bus), Some(digits)) = (
            singleton!(: UsbBusAllocator<UsbBus> = UsbBusAllocator::new(bus)),
            singleton!(: [u8; DIGITS] = serial_number()),
        ) else {
            panic!("started twice");
        };
        let port = SerialPort::new_with_store(bus, [0; RECEIVE_BYTES], [0; SEND_BYTES]);
        let (vendor, product) = USB_ID;
        let strings = StringDescriptors::default()
            .manufacturer("Breakaway")
            .product("Breakaway on a Pico 2")
            .serial_number(core::str::from_utf8(digits).unwrap_or("0"));
        let device = UsbDeviceBuilder::new(bus, UsbVidPid(vendor, product)).device_class(USB_CLASS_CDC);
        let Ok(device) = device.strings(&[strings]) else {
            panic!("one language has room");
        };
        Self { device: device.build(), port, idle_polls: 0 }
    }
}

/// The number of this chip, which no other has (RP2350, OTP, chip info). Several boards on one host keep their names.
fn serial_number() -> [u8; DIGITS] {
    let id = match chip_info() {
        Ok(Some(chip)) => u64::from(chip.wafer_id) << 32 | u64::from(chip.device_id),
        _ => 0,
    };
    core::array::from_fn(|place| {
        let digit = (id >> (4 * (DIGITS - 1 - place))) as u8 & 0xf;
        if digit < 10 { b'0' + digit } else { b'A' - 10 + digit }
    })
}

impl Wire for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        // Nothing there is an error of this driver.
        self.port.read(buffer).unwrap_or(0)
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        self.idle_polls = 0;
        self.port.write(bytes).unwrap_or(0)
    }

    fn flush(&mut self) {
        self.device.poll(&mut [&mut self.port]);
        let sent = self.port.flush().is_ok();
        self.idle_polls = if sent { self.idle_polls.saturating_add(1) } else { 0 };
    }

    fn idle(&self) -> bool {
        self.idle_polls >= SENT_POLLS
    }
}
