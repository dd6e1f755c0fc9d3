"""The panel of the takes: record, list, play, trim; its dialogs."""
