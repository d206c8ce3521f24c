// Inside the program's module (emcc --pre-js): what it prints goes to whoever started it, byte by byte, and it draws its progress.
// `Module.said(stream, byte)`: stream 1 or 2.
Module.thisProgram = "sensorchar"; // as reports have their command
Module.preRun = Module.preRun || [];
Module.preRun.push(() => {
  ENV.TERM = "page";
  ENV.NO_COLOR = "1";
  ENV.COLUMNS = "110";
  const say = stream => ({
    get_char: () => null,
    put_char: (tty, byte) => Module.said(stream, byte),
    flush: () => {},
    fsync: () => {},
  });
  Object.assign(TTY.default_tty_ops, say(1));
  Object.assign(TTY.default_tty1_ops, say(2));
});
// Under node too, the end of a command is not the end of everything.
Module.quit = (status, error) => {
  throw error;
};
